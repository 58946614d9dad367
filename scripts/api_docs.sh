#!/usr/bin/env bash
# Builds the pages of the library's public headers: scripts/api_docs.sh [FOLDER], by default out/site/api. Needs Doxygen.
# Their comments are plain ones; where they stand says what they are about. Whatever Doxygen warns of is an error.
set -euo pipefail
cd "$(dirname "$0")/.."

pages=$(realpath -m "${1:-out/site/api}")
if ! command -v doxygen >/dev/null; then
  echo "scripts/api_docs.sh needs Doxygen: apt-get install doxygen" >&2
  exit 1
fi

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
# The first comment is about the file, one behind a declaration about that, with the lines below it that are aligned
# with it; any other about what follows. Lines of dashes divide a file. "<name>" is a placeholder and no HTML.
cat >"$scratch/comments.awk" <<'EOF'
NR == 1 && /^\/\/ / { print "/// \\file"; print "///" }
/^ *\/\/ ----/ || /^struct [A-Za-z]+;/ { print ""; next }
/^ *\/\/( |$)/ { mark(index($0, "//") == behind ? "///<" : "///"); next }
/[^ ].*  \/\/ / && !/  \/\/ namespace / { behind = index($0, "  // ") + 2; mark("///<"); next }
{ behind = 0; print }
function mark(sign) {
  at = index($0, "//")
  text = substr($0, at + 2)
  gsub(/</, "\\<", text)
  print substr($0, 1, at - 1) sign text
}
EOF
cat >"$scratch/library.md" <<'EOF'
# The C++ library

The headers are under [Files](files.html), their classes and functions in the [namespace fjr](namespacefjr.html). What they
are for, how to link the library, and programs to begin with: docs/library.md.
EOF
cat >"$scratch/Doxyfile" <<EOF
PROJECT_NAME = fjr
PROJECT_BRIEF = "C++ library"
INPUT = $scratch/library.md $(sed -n 's/^  \([a-z_/]*\.h\))\?$/\1/p' cmake/public_headers.cmake | paste -sd ' ')
USE_MDFILE_AS_MAINPAGE = $scratch/library.md
FILTER_PATTERNS = "*.h=awk -f $scratch/comments.awk"
OUTPUT_DIRECTORY = $scratch
HTML_OUTPUT = $pages
GENERATE_LATEX = NO
HAVE_DOT = NO
EXTRACT_ALL = YES
JAVADOC_AUTOBRIEF = YES
STRIP_FROM_PATH = . $scratch
QUIET = YES
WARN_AS_ERROR = FAIL_ON_WARNINGS
EOF
mkdir -p "$pages"
doxygen "$scratch/Doxyfile"
echo "$pages/index.html"
