#!/usr/bin/env bash
# Builds README.md and docs/ into a site: scripts/docs.sh [FOLDER], by default out/site; and in api/ beside it the pages of
# the library. Needs MkDocs and Doxygen.
set -euo pipefail
cd "$(dirname "$0")/.."

site=$(realpath -m "${1:-out/site}")
if ! command -v mkdocs >/dev/null; then
  echo "scripts/docs.sh needs MkDocs: apt-get install mkdocs" >&2
  exit 1
fi

# The pages keep their places, for their links among each other and to files of the repository are relative. What they
# link to beside pages is copied as it is.
pages=$(mktemp -d)
trap 'rm -rf "$pages"' EXIT
python3 tests/docs.py --linked . | xargs -d '\n' cp --parents -t "$pages"
cat >"$pages.yml" <<EOF
site_name: fjr
docs_dir: $pages
site_dir: $site
use_directory_urls: false
theme: {name: readthedocs, highlightjs: false, navigation_depth: 2}
markdown_extensions: [tables, fenced_code, sane_lists, {toc: {permalink: true}}]
nav:
  - fjr: README.md
  - Documentation: docs/index.md
  - Planning:
      - Install: docs/install.md
      - Command line: docs/command-line.md
      - Requests: docs/requests.md
      - Files: docs/files.md
      - plan.json: docs/plan-json.md
      - Python: docs/python.md
      - C++ library: docs/library.md
      - Batches on many machines: docs/cluster.md
      - Exports: docs/exports.md
  - The arm and its machines:
      - Service: docs/service.md
      - Scaling: docs/scaling.md
      - ROS 2: docs/ros2.md
      - Executor: docs/executor.md
      - First motion on a real arm: planner/executor/README.md
      - DDS Security: config/security/README.md
      - Identification: docs/identification.md
      - New robot: docs/new-robot.md
  - How it works:
      - Theory: docs/theory.md
      - Architecture: docs/architecture.md
      - Extending: docs/extending.md
      - Performance: docs/performance.md
      - Benchmarks: bench/README.md
      - Peers: bench/peers/README.md
      - Comparison: docs/comparison.md
      - Planners for rigid arms: bench/rigid/README.md
  - To look things up:
      - FAQ: docs/faq.md
      - Glossary: docs/glossary.md
      - Changelog: CHANGELOG.md
EOF
trap 'rm -rf "$pages" "$pages.yml"' EXIT
mkdocs build --strict --quiet --config-file "$pages.yml"
scripts/api_docs.sh "$site/api" >/dev/null
echo "$site/index.html"
