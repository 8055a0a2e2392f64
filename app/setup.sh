#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs the Debian packages that thermorig needs and that are missing. Never removes one.
# Usage: bash app/setup.sh [page] [tests] [deep] [bench] [browser] [usb] [torch] [latex] [package] [cross] [--list]   (the words add what the live
# page and the charts of reports, tests, sanitizer runs, benchmarks, browser tests, tests on the kernel's usb-serial driver,
# the data set for PyTorch, tables in LaTeX, packages and their trial, and packages for arm64 need; --list prints them and installs nothing)
set -euo pipefail

packages=(g++ cmake ninja-build pkg-config ccache git ca-certificates
  libserialport-dev libseccomp-dev libboost-dev libhdf5-dev libfmt-dev libcli11-dev libtoml11-dev nlohmann-json3-dev
  zlib1g-dev libdeflate-dev libzstd-dev libmd-dev libeigen3-dev duktape-dev libonnx-dev libprotobuf-dev protobuf-compiler
  gcc-avr avr-libc libsimavr-dev)
# A node that came from elsewhere brings its npm and conflicts with Debian's.
add_node() { command -v npm >/dev/null || packages+=(nodejs npm); }
list=''
for part in "$@"; do
  case "$part" in
    page) add_node ;;
    tests) add_node; packages+=(libgtest-dev libgmock-dev avrdude librsvg2-bin hdf5-tools python3-h5py python3-xarray python3-h5netcdf python3-matplotlib python3-onnx
      python3-pandas python3-venv python3-pip python3-setuptools python3-wheel) ;;
    deep) packages+=(clang-14 lld-14 libclang-rt-14-dev clang-format-14 clang-tidy-14 llvm-14 python3 valgrind g++-aarch64-linux-gnu qemu-user
      gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm slurmctld slurmd slurm-client munge) ;;
    bench) packages+=(libbenchmark-dev python3-numpy python3-h5py python3-serial) ;;
    browser) packages+=(chromium) ;;
    torch) packages+=(python3-torch python3-numpy) ;;
    latex) packages+=(texlive-latex-recommended) ;;
    usb) packages+=(qemu-system-x86 busybox-static cpio python3) ;;
    package) add_node; packages+=(dpkg-dev lintian mandoc mmdebstrap xxd zsh fish) ;;
    --list) list=yes ;;
    cross) packages+=(g++-aarch64-linux-gnu qemu-user) ;;
    *) echo "setup.sh: unknown part '$part'; try: page, tests, deep, bench, browser, usb, torch, latex, package, cross" >&2; exit 2 ;;
  esac
done

[ -z "$list" ] || { printf '%s\n' "${packages[@]}"; exit; }
missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

if ! command -v apt-get >/dev/null; then
  echo "These packages (Debian's names) are missing; install them and run this again: ${missing[*]}" >&2
  exit 1
fi
refuse() {
  echo "setup.sh: $1" >&2
  echo "  try: $2; or let somebody who may install them, as root:" >&2
  echo "  apt-get install --no-remove --no-install-recommends ${missing[*]}" >&2
  exit 1
}
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || refuse "packages are missing, and there is no sudo to install them" "run it as root"
  as_root=(sudo)
fi
echo "Installing: ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -qq || refuse "apt-get update failed" "check the network, and that sudo lets you"
"${as_root[@]}" apt-get install -y -qq --no-remove --no-install-recommends "${missing[@]}" >/dev/null ||
  refuse "apt-get install failed" "read what it says above"
