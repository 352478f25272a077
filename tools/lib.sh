# Shared by the scripts of this folder: where things are, what must be installed, how to build.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# What building and running needs (Debian 12, Raspberry Pi OS 12).
build_packages=(g++ cmake ninja-build pkg-config liblcm-dev liblcm-bin libpcl-dev libflann-dev
  libeigen3-dev libtinyxml2-dev libcli11-dev libspdlog-dev nlohmann-json3-dev libcairo2-dev
  libyaml-cpp-dev libpng-dev zlib1g-dev libgtest-dev libgmock-dev libbenchmark-dev
  libncurses-dev python3 iproute2)
# What the jar of the types and lcm-spy need besides.
java_packages=(default-jdk-headless default-jre liblcm-java libjchart2d-java)
# What the sanitizer builds and the checks need besides.
check_packages=(xvfb tmux clang libclang-rt-14-dev llvm clang-format)

say() { printf '%s: %s\n' "$(basename "$0")" "$*" >&2; }

fail() {
  say "$*"
  exit 1
}

# install_packages NAME...: installs the Debian packages that are missing, as root or by sudo.
install_packages() {
  local missing=() package
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] ||
      missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null ||
      fail "these Debian packages are missing, and there is no sudo to install them: ${missing[*]}"
    as_root=(sudo)
  fi
  say "installing ${#missing[@]} Debian packages: ${missing[*]}"
  "${as_root[@]}" apt-get update -q >&2
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -q -y --no-install-recommends "${missing[@]}" >&2
}

# build_preset PRESET [TARGET...]: configures where needed and builds.
build_preset() (
  preset=$1
  shift
  cd "$root" # Of this subshell only: relative paths of the caller stay its own.
  [ -f "build/$preset/build.ninja" ] || cmake --preset "$preset" >&2
  cmake --build "build/$preset" --parallel "$(nproc)" --target "${@:-all}" >&2
)

# test_preset PRESET [CTEST-OPTION...]: runs the tests. A test's PROCESSORS counts half processors,
# since many a test only waits: tests/CMakeLists.txt says which takes how many.
test_preset() {
  ctest --preset "$1" --parallel "$((2 * $(nproc)))" "${@:2}"
}
