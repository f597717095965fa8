# SPDX-License-Identifier: Apache-2.0
# Debian packages by purpose, and `install_packages PURPOSE...`, which installs those that are missing. To be sourced.
# Debian 12 is what they are tested on.

packages_for() {
  case $1 in
    host) echo g++ cmake ninja-build doctest-dev ;;                              # the product and its tests
    clang) echo clang libclang-rt-14-dev ;;                                      # presets host-clang, host-sanitize
    arm) echo gcc-arm-none-eabi binutils-arm-none-eabi qemu-system-arm python3 ;;  # firmware, its tests in the emulator
    riscv) echo gcc-riscv64-unknown-elf ;;
    cli) echo libcli11-dev nlohmann-json3-dev libfmt-dev coinor-libclp-dev libmodbus-dev gnuplot-nox ;;  # the command line
    clients) echo mbpoll python3 python3-pymodbus python3-serial-asyncio ;;  # other people's, for tests
    lint) echo clang-format clang-tidy cppcheck python3 ;;
    bench) echo libbenchmark-dev ;;
    *) echo "packages.sh: no packages for: $1" >&2 && return 1 ;;
  esac
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

apt_install() {
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@"
}

install_packages() {
  local purpose package packages missing=()
  for purpose in "$@"; do
    packages=$(packages_for "$purpose") || return
    for package in $packages; do
      [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
    done
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  echo "== installing: ${missing[*]}"
  # A machine that has never updated, or not for long, has no or stale lists.
  apt_install "${missing[@]}" || { as_root apt-get update -q && apt_install "${missing[@]}"; }
}
