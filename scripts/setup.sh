#!/usr/bin/env bash
# Debian 12: installs what fjr needs, builds it into build/ and plans a first motion into out/reach.
set -euo pipefail
cd "$(dirname "$0")/.."

packages=(
  g++ cmake ninja-build pkg-config ccache                       # build
  libeigen3-dev libyaml-cpp-dev nlohmann-json3-dev libcli11-dev libfmt-dev libssl-dev
  libsundials-dev                                               # rollouts, virtual rig
  libceres-dev                                                  # identification
  libjs-chart.js                                                # reports: embedded in them
  coinor-libipopt-dev libmumps-seq-dev libopenblas0-serial      # optimisation; BLAS with one thread
  cyclonedds-dev cyclonedds-tools libspdlog-dev libsystemd-dev  # the planning service, its log and its watchdog
  openssl iproute2 nftables                                     # credentials; networks that lose packets, in tests
  systemd                                                       # systemd-analyze: the units are verified, in tests
  libgtest-dev libgmock-dev librapidcheck-dev libbenchmark-dev  # tests and benchmarks
  libfastrtps-dev fastddsgen default-jre-headless               # another DDS, to test against
  python3 python3-venv python3-dev                              # bench/suite.py, a client in Python
  python3-pandas octave                                         # programs that read our tables, in tests
  clang-format clang-tidy                                       # style
  mkdocs                                                        # docs/ as a site
)
missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
if ((${#missing[@]})); then
  as_root=()
  ((EUID == 0)) || as_root=(sudo)
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends "${missing[@]}"
fi

cmake --preset release
cmake --build --preset release
build/fjr plan config/requests/reach.yaml --out out/reach
