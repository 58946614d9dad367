#!/usr/bin/env bash
# All tests; then the fast ones again with AddressSanitizer and UndefinedBehaviorSanitizer. Presets make warnings errors.
set -euo pipefail
cd "$(dirname "$0")/.."

cmake --preset release
cmake --build --preset release
cmake --preset asan

# Tests of the service run alone, and mostly wait: meanwhile, and only with what they leave, the next build.
nice -n 19 ninja -C build-asan >/dev/null 2>&1 &
build=$!
trap 'kill "$build" 2>/dev/null || true' EXIT
ctest --preset release -j "$(nproc)"
wait "$build" || true  # what went wrong is told by the next line

cmake --build --preset asan
ctest --preset asan -j "$(nproc)"
