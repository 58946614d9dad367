#!/usr/bin/env bash
# Debian 12: installs what fjr needs, builds it into build/ and plans a first motion into out/reach. What the tests need
# beside that, scripts/test.sh installs and builds.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

install_packages "${program_packages[@]}"
cmake --preset program
cmake --build --preset program
build/fjr plan config/requests/reach.yaml --out out/reach
