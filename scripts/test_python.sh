#!/usr/bin/env bash
# Installs what build/ has, builds the Python package against that into a virtual environment, and tests it: types,
# examples in docstrings, tests, notebook. Needs the build of scripts/setup.sh, and PyPI.
set -euo pipefail
cd "$(dirname "$0")/.."

mkdir -p build-python
venv=$PWD/build-python/venv
prefix=$PWD/build-python/fjr
[[ -x $venv/bin/python ]] || python3 -m venv "$venv"
"$venv/bin/pip" install --quiet --disable-pip-version-check -r python/tests/requirements.txt
cmake --install build --prefix "$prefix" >/dev/null
"$venv/bin/pip" install --quiet --disable-pip-version-check --no-build-isolation --no-deps --force-reinstall . \
  -C cmake.source-dir=python -C cmake.define.CMAKE_PREFIX_PATH="$prefix" -C build-dir=build-python/module

# From elsewhere: what is tested is the package as it is installed, not the folder beside this script.
tests=$PWD/python/tests
export FJR_PROGRAM=$PWD/build/fjr
cd build-python
"$venv/bin/python" -m mypy --strict -p fjr
"$venv/bin/python" -m mypy --strict "$tests/example.py"
"$venv/bin/python" -m pytest -q --doctest-modules --pyargs fjr
# What is said over DDS stays among these processes.
namespace=-n
unshare -n true 2>/dev/null || namespace=-rn
unshare $namespace sh -c 'ip link set lo up; exec "$@"' sh "$venv/bin/python" -m pytest -q "$tests"
