# Debian's packages: install what is missing of those named. Sourced by the other scripts.

program_packages=(
  g++ cmake ninja-build pkg-config ccache                       # build
  libeigen3-dev libyaml-cpp-dev nlohmann-json3-dev libcli11-dev libfmt-dev libssl-dev
  libsundials-dev                                               # rollouts, virtual rig
  libceres-dev                                                  # identification
  libsqlite3-dev zlib1g-dev                                     # batches in few files
  libmatio-dev                                                  # exports as MATLAB files
  libjs-chart.js                                                # reports: embedded in them
  coinor-libipopt-dev libmumps-seq-dev libopenblas0-serial      # optimisation; BLAS with one thread
  cyclonedds-dev cyclonedds-tools libspdlog-dev libsystemd-dev  # the planning service, its log and its watchdog
  libcpp-httplib-dev                                            # its metrics over HTTP
  openssl                                                       # credentials of a secured service
)
test_packages=(
  iproute2 nftables                                             # networks that lose packets
  systemd systemd-container                                     # systemd-analyze: the units are verified; and run
  libgtest-dev libgmock-dev librapidcheck-dev libbenchmark-dev libmpfr-dev  # tests and benchmarks
  python3-prometheus-client                                     # reads the service's metrics
  locales                                                       # one that writes a comma, to test numbers with
  libfastrtps-dev fastddsgen default-jre-headless               # another DDS, to test against
  python3 python3-venv python3-dev                              # bench/suite.py, a client in Python
  slurm-wlm munge parallel                                      # engines that run batches
  python3-pandas octave                                         # programs that read our tables
  chromium chromium-driver python3-selenium fonts-dejavu-core   # reports in a browser
  help2man                                                      # man pages
  clang-format clang-tidy                                       # style
  mkdocs doxygen                                                # docs/ as a site, and the library's pages
)
make_packages=(
  dpkg-dev file help2man                                        # Debian packages; man pages in them
  python3 python3-dev python3-venv                              # python3-fjr
)

install_packages() {
  local missing=() as_root=() package
  for package in "$@"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  echo "installing ${#missing[@]} packages: ${missing[*]}"
  ((EUID == 0)) || as_root=(sudo)
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends "${missing[@]}"
}
