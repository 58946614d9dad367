#!/usr/bin/env bash
# Installs the Debian packages of a folder in a clean Debian, and uses them: scripts/test_packages.sh [FOLDER [SUITE]], by
# default out/packages and the Debian that it runs on. Needs root, mmdebstrap and the network, and takes minutes. Makes
# the packages of what is committed if there are none, in a Debian of the suite.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh
install_packages mmdebstrap

here=$(. /etc/os-release && echo "$VERSION_CODENAME")
folder=$(realpath -m "${1:-out/packages}")
suite=${2:-$here}

# With the certificates of this machine: its network may have an authority of its own between it and PyPI.
make_in_suite() {
  mkdir -p "$folder"
  mmdebstrap --quiet --variant=apt --include=ca-certificates \
    --customize-hook='mkdir "$1/fjr"' \
    --customize-hook='copy-in /etc/ssl/certs/ca-certificates.crt /etc/ssl/certs' \
    --customize-hook='git archive HEAD | tar -x -C "$1/fjr"' \
    --customize-hook='chroot "$1" bash /fjr/scripts/make_packages.sh /packages' \
    --customize-hook="sync-out /packages $folder" \
    "$suite" /dev/null
}

if ! compgen -G "$folder/*.deb" >/dev/null; then
  if [[ $suite == "$here" ]]; then scripts/make_packages.sh "$folder"; else make_in_suite; fi
fi

inside=$(mktemp)
trap 'rm -f "$inside"' EXIT
cat >"$inside" <<'EOF'
set -eux
export DEBIAN_FRONTEND=noninteractive
cd /packages
apt-get update -q

# The program, by itself: it plans in any folder, for anybody.
apt-get install -qy --no-install-recommends ./fjr_*.deb
useradd --create-home somebody
as() { su somebody -c "cd && $1"; }
fjr --version
ldd /usr/bin/fjr /usr/lib/*/fjr/fjr | grep -c 'not found' && exit 1
as 'fjr plan /usr/share/fjr/config/requests/reach.yaml --out reach --report'
as 'fjr verify reach/trajectory.csv'
as 'fjr verify reach/trajectory.csv --json' | grep -q certified
test -s /home/somebody/reach/report.html
test -s /usr/share/man/man1/fjr-plan.1.gz
test -s /usr/share/doc/fjr/fjr.spdx.json
bash -c 'source /usr/share/bash-completion/completions/fjr && complete -p fjr'
test -f /usr/lib/systemd/system/fjr.service
grep -q '^ExecStart=/usr/bin/fjr serve --config /etc/fjr/service.yaml' /usr/lib/systemd/system/fjr.service

# The machine's own configuration is kept.
echo '# mine' >>/etc/fjr/service.yaml
apt-get install -qy --no-install-recommends --reinstall ./fjr_*.deb
tail -n 1 /etc/fjr/service.yaml | grep -q mine

# Python.
apt-get install -qy --no-install-recommends ./python3-fjr_*.deb
as "python3 -c \"
import fjr
plan = fjr.plan({'start': {'q': [0, 0]}, 'goal': {'q': [1.2, -0.8]}})
assert plan.status == 'certified' and plan.tau.shape == (len(plan.time), 2), plan
print(plan)
\""
as 'python3 -m fjr --version'

# The library.
apt-get install -qy --no-install-recommends ./libfjr-dev_*.deb cmake make g++
cmake -S /example -B /tmp/example
cmake --build /tmp/example
chmod 755 /tmp/example
as '/tmp/example/reach && /tmp/example/check reach.csv'

# And away again.
apt-get purge -qy fjr libfjr-dev python3-fjr
for left in /usr/bin/fjr /usr/lib/*/fjr /usr/share/fjr /usr/include/fjr /usr/lib/python3/dist-packages/fjr /etc/fjr; do
  if test -e "$left"; then
    echo "$left is left" >&2
    exit 1
  fi
done
EOF

mmdebstrap --quiet --variant=apt --include=ca-certificates \
  --customize-hook='mkdir "$1/packages" "$1/example"' \
  --customize-hook="copy-in $(echo "$folder"/*.deb) /packages" \
  --customize-hook='copy-in examples/cmake/CMakeLists.txt examples/cmake/reach.cc examples/cmake/check.cc /example' \
  --customize-hook="upload $inside /inside.sh" \
  --customize-hook='chroot "$1" bash /inside.sh' \
  "$suite" /dev/null
echo "the packages of $folder work in a clean Debian $suite"
