#!/usr/bin/env bash
# Reads exports back with the field's own readers, which are Python packages of pinned versions in an environment of their own.
# Needs build/fjr, or the program that the environment variable FJR names.
set -euo pipefail
cd "$(dirname "$0")/.."

environment=build/exports-env
python3 -m venv "$environment"
"$environment/bin/pip" install -q --disable-pip-version-check -r tests/exports/requirements.txt
"$environment/bin/python" -m pytest -q -p no:cacheprovider tests/exports "$@"
