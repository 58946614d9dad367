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

# What is private stays here, and no header is installed that no public one includes.
for private in planner/nlp/nlp.h planner/search/session.h planner/dds planner/program planner/service; do
  if [[ -e $prefix/include/fjr/$private ]]; then
    echo "$private is installed, and is not for others" >&2
    exit 1
  fi
done

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

headers=$(sed -n 's/^  \([a-z0-9_/]*\.h\))\?$/\1/p' "$source/cmake/public_headers.cmake" | paste -sd ';')
compile "$source/tests/library" "$work/headers" -D HEADERS="$headers"
"$work/headers/every_header"
compile "$source/examples/cmake" "$work/example" -D CMAKE_CXX_FLAGS="-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror"

# From elsewhere, and without FJR_CONFIG_DIR.
unset FJR_CONFIG_DIR
cd "$work/example"
./reach
./check reach.csv
"$prefix/bin/fjr" verify reach.csv
if ./check /dev/null; then
  echo "an empty file was certified" >&2
  exit 1
fi
