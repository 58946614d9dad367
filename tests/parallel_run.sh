#!/usr/bin/env bash
# A packed batch under GNU parallel, which is killed and started again, with chunks named twice:
#     tests/parallel_run.sh BUILD
# Needs Debian's parallel. Every request has to be answered once. Exit code 77: there is none.
set -euo pipefail
build=$(cd "${1:?usage: $0 BUILD}" && pwd)
command -v parallel > /dev/null || { echo "there is no GNU parallel"; exit 77; }
export PARALLEL_HOME
PARALLEL_HOME=$(mktemp -d)  # where it keeps what it knows of this machine
work=$PARALLEL_HOME/batch
trap 'rm -rf "$PARALLEL_HOME"' EXIT
mkdir "$work"

cat > "$work/grid.yaml" <<'GRID'
request: {start: {q: [0.3, 0.2]}, goal: {q: [0.3, 0.21]}, sample_period: 0.005}
axes:
  goal.q[1]: {from: 0.21, to: 0.31, count: 11}
GRID
"$build/fjr" batch prepare "$work/grid.yaml" --out "$work/out" --chunk-size 4
field() { "$build/fjr" batch status "$work/out" --json | python3 -c 'import json, sys; print(json.load(sys.stdin)[sys.argv[1]])' "$1"; }
expect() { [[ $(field "$1") == "$2" ]] || { echo "FAILED  $1 is $(field "$1"), not $2"; exit 1; }; echo "ok      $1 is $2"; }

# A session of its own, so that all of it can be killed.
setsid parallel --jobs 2 "$build/fjr" batch run "$work/out" {} --jobs 1 --quiet ::: 1 2 3 > "$work/killed.log" 2>&1 &
session=$!
for _ in {1..600}; do (($(field planned) >= 3)) && break; sleep 0.1; done
pkill -KILL --session "$session"
wait "$session" 2> /dev/null || true
before=$(field planned)
((before < 11)) || { echo "FAILED  all was planned before the kill"; exit 1; }
echo "ok      killed with $before answers"
parallel --jobs 3 "$build/fjr" batch run "$work/out" {} --jobs 1 --quiet ::: 1 1 2 2 3 3
expect planned 11
expect status "{'certified': 11}"
expect unfinished "[]"
"$build/fjr" batch gather "$work/out"
