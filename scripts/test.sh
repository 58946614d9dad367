#!/usr/bin/env bash
# Installs what they need, and runs all tests; then the fast ones again with AddressSanitizer and UndefinedBehaviorSanitizer. Presets make warnings errors.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh
install_packages "${program_packages[@]}" "${test_packages[@]}"

# Control ticks are real time: where other work holds up the machine, a motion is stopped for missed ticks, as it should be.
# What fails is therefore run again when nothing else runs, up to three times; what fails every time is wrong.
run_tests() {
  ctest --preset "$1" -j "$(nproc)" && return
  wait
  ctest --preset "$1" --rerun-failed --repeat until-pass:3
}

rm -rf build/tmp build-asan/tmp  # what earlier tests have left that were killed; configuring makes the folders again
cmake --preset release
cmake --build --preset release
cmake --preset asan

# Tests of the service mostly wait, and those that are judged by the clock run alone: meanwhile, and only with what tests leave,
# the next build.
nice -n 19 ninja -C build-asan >/dev/null 2>&1 &
build=$!
trap 'kill "$build" 2>/dev/null || true' EXIT
run_tests release
wait "$build" || true  # what went wrong is told by the next line

cmake --build --preset asan
run_tests asan
