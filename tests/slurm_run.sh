#!/usr/bin/env bash
# A packed batch on a Slurm cluster of its own, which is hurt in every way that clusters know:  tests/slurm_run.sh BUILD
# Needs Debian's slurm-wlm and munge, and root. Controller and two node daemons, `one` and `two`, run on this machine with
# their own configuration, key and ports. While chunks are planned, the daemon of `one` is killed and its node given up,
# the task on `two` is preempted, and one is killed. Every request has to be answered once. Exit code 77: that cannot be had here.
set -euo pipefail
build=$(cd "${1:?usage: $0 BUILD}" && pwd)

skip() { echo "$1"; exit 77; }

work=$(mktemp -d)
chmod 755 "$work"
export SLURM_CONF=$work/slurm.conf
end_all() {
  scancel --quiet --user=root 2> /dev/null || true
  for pid in "$work"/*.pid; do kill -9 "$(cat "$pid" 2> /dev/null)" 2> /dev/null || true; done
  sleep 0.5
  rm -rf "$work"
}
trap end_all EXIT

failed=0
expect() {  # what it is about, and a command that is to succeed
  local about=$1 begin=$SECONDS
  shift
  if "$@"; then echo "ok      $about ($((SECONDS - begin)) s)"; else echo "FAILED  $about"; failed=1; fi
}

# What is made of a fjr that fails, with stand-ins for it and for sbatch; this needs no Slurm.
stand_ins=$work/stand_ins
mkdir -p "$stand_ins/out"
cp "$build/fjr-batch-slurm" "$stand_ins"
cat > "$stand_ins/fjr" <<'FJR'
#!/bin/sh
[ "$2" = status ] || exit 0
cat "$(dirname "$0")/left" 2> /dev/null || exit 2  # the unfinished chunks
FJR
printf '#!/bin/sh\necho 1\n' > "$stand_ins/sbatch"
chmod +x "$stand_ins"/{fjr,sbatch}
# what_comes_of ARGUMENT...: what the script says, and its exit code.
what_comes_of() {
  local code=0
  PATH=$stand_ins:$PATH "$stand_ins/fjr-batch-slurm" "$@" 2>&1 || code=$?
  echo "exit code $code"
}
gathered() { what_comes_of --gather "$stand_ins/fjr" "$stand_ins/out" "$stand_ins/fjr-batch-slurm" "$1"; }
expect "a fjr that fails has nothing submitted" test "$(what_comes_of some.yaml --out "$stand_ins/out")" == "exit code 2"
expect "nor submitted again, and is no success" test "$(gathered 1)" == \
  $'fjr-batch-slurm: not submitted again, which the same command does\nexit code 1'
expect "nor is it one at the end" test "$(gathered 2)" == "exit code 1"
expect "nothing was submitted" test ! -e "$stand_ins/out/slurm.jobs"
echo 0,2 > "$stand_ins/left"
expect "what is left at the end is no success" test "$(gathered 2)" == "exit code 1"
true > "$stand_ins/left"
expect "where nothing is left it is one" test "$(gathered 2)" == "exit code 0"
((failed == 0)) || exit 1

[[ $(id -u) == 0 ]] || skip "only root can run slurmd"
for program in munged slurmctld slurmd sbatch; do
  command -v "$program" > /dev/null || skip "there is no $program (slurm-wlm, munge)"
done

mkdir "$work"/{state,one,two}
head -c 128 /dev/urandom > "$work/munge.key"
chmod 600 "$work/munge.key"
munged --force --key-file="$work/munge.key" --socket="$work/munge.socket" --pid-file="$work/munge.pid" \
  --log-file="$work/munge.log" --seed-file="$work/munge.seed" 2> /dev/null
host=$(hostname)
port=$((16000 + $$ % 16000))
cat > "$SLURM_CONF" <<CONF
ClusterName=trial
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
AuthInfo=socket=$work/munge.socket,cred_expire=5
SlurmctldPort=$port
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.%n.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SchedulerParameters=sched_interval=1,bf_interval=1
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
ReturnToService=2
KillWait=5
NodeName=one NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1 RealMemory=2000
NodeName=two NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1 RealMemory=2000
PartitionName=low Nodes=one,two Default=YES PriorityTier=1
PartitionName=high Nodes=one,two PriorityTier=10 PreemptMode=OFF
CONF

within_a_minute() { for _ in {1..600}; do "$@" && return; sleep 0.1; done; return 1; }
node_is() { [[ $(sinfo --noheader --nodes="$1" --partition=low --format=%T) == "$2" ]]; }
status() { "$build/fjr" batch status "$work/out" --json | python3 -c 'import json, sys; print(json.load(sys.stdin)[sys.argv[1]])' "$1"; }
queue_is_empty() { [[ -z $(squeue --noheader) ]]; }
# The task on a node, as 1_3.
task_on() { squeue --noheader --nodelist="$1" --states=RUNNING --name=fjr-batch --format=%i; }
task_runs_on() { [[ -n $(task_on "$1") ]]; }
# The process of a task; of one that was started twice the later.
planner_of() { pgrep --newest --full "^$build/fjr batch run $work/out ${1#*_} "; }
plans_on() { task_runs_on "$1" && planner_of "$(task_on "$1")" > /dev/null; }
field_of() { scontrol --oneliner show job "$1" | grep -oE "$2=[A-Z0-9]+" | head -1; }
was_requeued() { [[ $(field_of "$1" Restarts) == Restarts=1 ]]; }

slurmctld -c
for node in one two; do slurmd -N "$node" -c; done
within_a_minute node_is one idle && within_a_minute node_is two idle || skip "no Slurm starts here"

requests=${REQUESTS:-90}  # planning a chunk has to take longer than two calls of fjr batch status
mkdir "$work/requests"
cat > "$work/requests/grid.yaml" <<'GRID'
request: {start: {q: [0.3, 0.2]}, goal: {q: [0.3, 0.21]}, sample_period: 0.005}
axes:
  goal.q[1]: {from: 0.21, to: 0.31, count: REQUESTS}
GRID
sed -i "s/REQUESTS/$requests/" "$work/requests/grid.yaml"
submit() { "$build/fjr-batch-slurm" "$work/requests" --out "$work/out" --chunk-size $((requests / 3)) -- --cpus-per-task=1; }
submit

expect "chunks are planned on both nodes" within_a_minute eval 'plans_on one && plans_on two'
on_one=$(task_on one) on_two=$(task_on two)
expect "and some of their requests are answered" within_a_minute eval '(($(status planned) >= 2))'

orphan=$(planner_of "$on_one")
kill -9 "$(cat "$work/slurmd.one.pid")"
kill -STOP "$orphan"  # the machine hangs, and goes on when its task runs elsewhere
scontrol update nodename=one state=down reason=trial
expect "the task of a node that was given up is queued again" within_a_minute was_requeued "$on_one"
expect "while its planner lives on" kill -0 "$orphan"
sbatch --partition=high --nodelist=two --output=/dev/null --wrap='sleep 1' > /dev/null
expect "the task on the other node is preempted" within_a_minute was_requeued "$on_two"
expect "the chunk whose planner lives on is started, and waits" within_a_minute \
  eval '[[ $(task_on two) == "$on_one" ]] && plans_on two'
kill -CONT "$orphan"
expect "its planner ends as if nothing had happened" within_a_minute eval '! kill -0 "$orphan" 2> /dev/null'

slurmd -N one -c
expect "the node is back" within_a_minute eval 'node_is one idle || node_is one allocated || node_is one mixed'
answered=$(status planned)
expect "the preempted chunk goes on" within_a_minute eval 'planner_of "$on_two" > /dev/null && (($(status planned) > answered))'
kill -9 "$(planner_of "$on_two")"
expect "a planner that is killed fails its task" within_a_minute eval '[[ $(field_of "$on_two" JobState) == JobState=FAILED ]]'
expect "while something is in the queue, nobody submits it again" eval '! submit 2> /dev/null > /dev/null'
expect "all jobs end" within_a_minute queue_is_empty
expect "the failed chunk was submitted once more: two arrays, two that gather" test "$(wc -l < "$work/out/slurm.jobs")" == 4
expect "nothing is unfinished" test "$(status unfinished)" == "[]"
expect "nothing is lost" test "$(status status)" == "{'certified': $requests}"
expect "nothing was planned twice" test "$(status planned)" == "$requests"
cat > "$work/runs.py" <<'RUNS'
"""No two of a chunk's runs at the same time; a row and the files of a plan for each request."""
import glob, sqlite3, sys
for file in sorted(glob.glob(sys.argv[1] + "/chunks/*.sqlite")):
    runs = sqlite3.connect(file).execute("SELECT run, process, began, ended, planned FROM runs ORDER BY run").fetchall()
    print(file[-12:], *runs)
    for before, after in zip(runs, runs[1:]):
        assert before[3] is None or before[3] <= after[2], (before, after)  # None: it was killed
names = sqlite3.connect(sys.argv[1] + "/results.sqlite").execute("SELECT count(DISTINCT name) FROM results").fetchone()
assert names == (int(sys.argv[2]),), names
RUNS
expect "nobody has planned the same chunk at the same time" python3 "$work/runs.py" "$work/out" "$requests"
expect "a plan that is unpacked verifies" eval \
  '"$build/fjr" batch unpack "$work/out" grid_0.21 --out "$work/one" && "$build/fjr" verify "$work/one/trajectory.csv" > /dev/null'
expect "and the same command again finds nothing to do" eval 'submit | grep -q "nothing is left"'
((failed == 0)) || { cat "$work/out/slurm.log"; tail -20 "$work/slurmctld.log"; }
exit "$failed"
