#!/usr/bin/env bash
# Ruckig, TOPP-RA and fjr on the same motions: bench/rigid/run.sh [OPTIONS of run.py]. Makes its own Python environment in
# build-rigid/, with pinned packages from PyPI (200 MB). Needs fjr built.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."

[[ -x build-rigid/bin/python ]] || python3 -m venv build-rigid
build-rigid/bin/pip install --quiet --disable-pip-version-check -r "$here/requirements.txt"
exec build-rigid/bin/python "$here/run.py" "$@"
