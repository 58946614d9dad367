#!/usr/bin/env bash
# The library as it is installed:  tests/library/test.sh BUILD
# It is installed, moved to another folder, and built against there, by programs in C++ alone that say nothing of language
# versions, packages or configuration. The example plans a motion that its other program, and the installed one, certify.
set -euo pipefail
build=$(cd "${1:?usage: $0 BUILD}" && pwd)
source=$(cd "$(dirname "$0")/../.." && pwd)

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/moved/fjr
mkdir "$work/moved"
cmake --install "$build" --prefix "$work/first" > /dev/null
mv "$work/first" "$prefix"

# What is private stays here: the list is what is installed, all of it, and each header can be included by itself.
headers=$(sed -n 's/^  \([a-z0-9_/]*\.h\))\?$/\1/p' "$source/cmake/public_headers.cmake")
diff <(sort <<< "$headers") <(cd "$prefix/include/fjr" && find . -type f -printf '%P\n' | sort) ||
  { echo "the headers that are installed are not those of cmake/public_headers.cmake" >&2; exit 1; }
mkdir "$work/alone"
for header in $headers; do
  echo "#include \"$header\"" > "$work/alone/${header//\//_}.cc"
done
printf '%s\n' "$work"/alone/*.cc | xargs -P "$(nproc)" -n 1 "${CXX:-c++}" -std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic \
  -Werror -I "$prefix/include/fjr" $(pkg-config --cflags-only-I eigen3 | sed 's/-I/-isystem /g')

launcher=()
if command -v ccache > /dev/null; then launcher=(-D CMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
compile() {
  local project=$1 to=$2
  shift 2
  cmake -S "$project" -B "$to" -G Ninja -D CMAKE_PREFIX_PATH="$prefix" "${launcher[@]}" "$@" > "$work/log" 2>&1 &&
    cmake --build "$to" >> "$work/log" 2>&1 && return
  cat "$work/log" >&2
  exit 1
}

compile "$source/tests/library" "$work/headers" -D HEADERS="$(paste -sd ';' <<< "$headers")"
"$work/headers/every_header"
compile "$source/examples/cmake" "$work/example" -D CMAKE_CXX_FLAGS="-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror"

# From elsewhere, and without FJR_CONFIG_DIR.
unset FJR_CONFIG_DIR
cd "$work/example"
./reach
./check reach.csv
"$prefix/bin/fjr" verify reach.csv
"$prefix/bin/fjr" simulate reach.csv --out simulated.csv  # by the complete executable
if ./check /dev/null; then
  echo "an empty file was certified" >&2
  exit 1
fi
