#!/usr/bin/env bash
# All tests; then the fast ones again with AddressSanitizer and UndefinedBehaviorSanitizer. Presets make warnings errors.
set -euo pipefail
cd "$(dirname "$0")/.."

for preset in release asan; do
  cmake --preset "$preset"
  cmake --build --preset "$preset"
  ctest --preset "$preset" -j "$(nproc)"
done
