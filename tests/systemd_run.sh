#!/usr/bin/env bash
# Runs the three installed units under a systemd of their own, with credentials:  tests/systemd_run.sh BUILD
# As root, with systemd-nspawn (Debian: systemd-container). It boots a copy-on-write view of this machine without a
# network, and leaves nothing behind. Exit code 77: that cannot be had here.
set -euo pipefail
build=$(cd "${1:?usage: $0 BUILD}" && pwd)

skip() { echo "$1"; exit 77; }
[[ $(id -u) == 0 ]] || skip "only root can run a systemd"
command -v systemd-nspawn > /dev/null || skip "there is no systemd-nspawn (systemd-container)"

work=$(mktemp -d)
root=$work/root
trap 'umount "$root" 2> /dev/null; umount "$work" 2> /dev/null; rmdir "$work"' EXIT
mount -t tmpfs tmpfs "$work" || skip "mounts are not allowed here"
mkdir "$work"/{root,upper,work}
mount -t overlay overlay -o "lowerdir=/,upperdir=$work/upper,workdir=$work/work" "$root" || skip "no overlays here"

DESTDIR=$root cmake --install "$build" --prefix /usr/local > /dev/null
"$root/usr/local/share/fjr/config/security/make_credentials.sh" "$root/etc/fjr/security" > /dev/null 2>&1
printf 'start: {q: [0, 0]}\ngoal: {q: [0.3, -0.2]}\nobjective: fastest\n' > "$root/there.yaml"
printf 'goal: {q: [0, 0]}\nobjective: fastest\n' > "$root/back.yaml"
mkdir -p "$root/etc/systemd/system/multi-user.target.wants"
sed -i 's|^# remember: DIR .*|remember: /var/lib/fjr|; s|^# metrics: |metrics: |' "$root/etc/fjr/service.yaml"
for unit in fjr fjr-worker fjr-executor; do
  ln -sf "/usr/local/lib/systemd/system/$unit.service" "$root/etc/systemd/system/multi-user.target.wants/"
done

cat > "$root/trial.sh" <<'TRIAL'
#!/usr/bin/env bash
exec > /trial.log 2>&1
failed=0
expect() {  # what it is about, and a command that is to succeed
  local about=$1 begin=$SECONDS
  shift
  if "$@"; then echo "ok      $about ($((SECONDS - begin)) s)"; else echo "FAILED  $about"; failed=1; fi
}
become() { for _ in {1..150}; do [[ $("$@") == "$wanted" ]] && return; sleep 0.1; done; "$@"; return 1; }
show() { systemctl show -P "$2" "$1"; }
main() { show "$1" MainPID; }
as() { FJR_SECURITY=/etc/fjr/security/$1 timeout 60 fjr "${@:2}"; }
slots() { as observer status --json | python3 -c 'import json, sys; print(json.load(sys.stdin)["services"][0]["workers"]["all"])'; }
page() { python3 -c 'import urllib.request as u; print(u.urlopen("http://127.0.0.1:9464/metrics").read().decode())'; }
moves() { as client request "$1" --execute | grep -q 'code 0 SUCCESSFUL'; }

wanted=active
expect "the service runs" become show fjr ActiveState
expect "the worker runs" become show fjr-worker ActiveState
expect "the executor runs" become show fjr-executor ActiveState
for unit in fjr fjr-worker fjr-executor; do
  user=$(ps -o uid= -p "$(main $unit)")
  expect "$unit is not root but user $user" test "$user" -ge 61184
  expect "$unit has its credentials by systemd" test -r "/run/credentials/$unit.service/key.pem"
  expect "$unit cannot read those of /etc" bash -c "! setpriv --reuid $user --clear-groups cat /etc/fjr/security/executor/key.pem 2> /dev/null"
done
if bash -c 'ulimit -r 99 -l unlimited' 2> /dev/null; then
  expect "the tick is first-in first-out at 80" bash -c "ps -L -o cls=,rtprio= -p $(main fjr-executor) | grep -qE 'FF +80'"
  expect "memory is locked" grep -qE 'VmLck:\s+[1-9]' "/proc/$(main fjr-executor)/status"
else
  echo "left out  real-time priority and locked memory: root may not raise limits here (CAP_SYS_RESOURCE)"
fi
wanted=2
expect "the owner has its own slot and the worker's" become slots
expect "a motion is planned and executed" moves /there.yaml
expect "metrics are served" eval 'page | grep -q "^fjr_replies_total.*SOLVED.* 1"'
expect "without credentials nobody is served" bash -c '! timeout 20 fjr status > /dev/null'
expect "fjr hold succeeds" as client hold
before=$(main fjr)
kill -STOP "$before"
wanted=1
expect "a service that hangs is started again by the watchdog" become show fjr NRestarts
wanted=active
expect "and runs" become show fjr ActiveState
expect "and remembers what it has answered" eval 'journalctl --sync; journalctl -o cat -u fjr | grep -q "remembers 1 earlier repl"'
expect "the arm moves back" moves /back.yaml
expect "the worker ends when it is told to" systemctl stop fjr-worker
expect "and with code 0" test "$(show fjr-worker ExecMainStatus)" == 0
expect "the executor ends when it is told to" systemctl stop fjr-executor
expect "and with code 0" test "$(show fjr-executor ExecMainStatus)" == 0
expect "the service ends when it is told to" systemctl stop fjr
expect "and with code 0" test "$(show fjr ExecMainStatus)" == 0
expect "what the executor has run outlives it" test -s /var/lib/fjr-executor/executor-0-arm
journalctl --no-pager -o cat -u fjr -u fjr-worker -u fjr-executor > /journal.log
echo "$failed" > /trial.result
systemctl poweroff --force
TRIAL
chmod +x "$root/trial.sh"
cat > "$root/etc/systemd/system/fjr-trial.service" <<'UNIT'
[Service]
Type=simple
ExecStart=/trial.sh
UNIT
ln -s ../fjr-trial.service "$root/etc/systemd/system/multi-user.target.wants/"

timeout 180 systemd-nspawn --quiet --register=no --keep-unit --private-network --directory="$root" \
  --capability=CAP_IPC_LOCK,CAP_SYS_NICE --system-call-filter="@memlock @resources" --boot \
  systemd.unit=multi-user.target > "$work/boot.log" 2>&1 || true
[[ -e $root/trial.log ]] || { tail -20 "$work/boot.log"; skip "systemd does not start here"; }
cat "$root/trial.log"
[[ $(cat "$root/trial.result" 2> /dev/null) == 0 ]] || { cat "$root/journal.log"; exit 1; }
