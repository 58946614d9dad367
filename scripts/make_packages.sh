#!/usr/bin/env bash
# Makes fjr, libfjr-dev and python3-fjr for the Debian that it runs on: scripts/make_packages.sh [FOLDER], by default
# out/packages. Installs what that needs; nanobind, which Debian does not have in a version that will do, is PyPI's.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh
install_packages "${program_packages[@]}" "${make_packages[@]}"

folder=$(realpath -m "${1:-out/packages}")
mkdir -p build-package "$folder"
venv=$PWD/build-package/venv
[[ -x $venv/bin/python ]] || /usr/bin/python3 -m venv "$venv"
"$venv/bin/pip" install --quiet --disable-pip-version-check "$(grep '^nanobind==' python/tests/requirements.txt)"

cmake --preset package -D Python_EXECUTABLE=/usr/bin/python3 -D nanobind_DIR="$("$venv/bin/python" -m nanobind --cmake_dir)"
cmake --build --preset package
cpack --config build-package/CPackConfig.cmake -B "$folder"
rm -rf "$folder/_CPack_Packages"
ls "$folder"/*.deb
