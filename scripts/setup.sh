#!/usr/bin/env bash
# Debian 12: installs what fjr needs, plans a first motion into out/reach as soon as it can, and builds the rest of fjr into
# build/. What the tests need beside that, scripts/test.sh installs and builds.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

step() { printf '\n== %s, after %d:%02d\n' "$1" $((SECONDS / 60)) $((SECONDS % 60)); }

install_packages "${program_packages[@]}"
step "building what a first plan needs"
cmake --preset program
cmake --build --preset program --target fjr
build/fjr plan config/requests/reach.yaml --out out/reach --report
step "the first plan is in out/reach (report.html shows it); build/fjr plans, verifies and reports by now; building the rest"
cmake --build --preset program
build/fjr completion bash >/dev/null  # a command of the other executable
step "build/fjr is complete"
