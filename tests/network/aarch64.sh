#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The network module and its tests, compiled for AArch64 (a Raspberry Pi's 64-bit system) and run by an emulator of its
# processor. Needs g++-aarch64-linux-gnu and qemu-user (app/setup.sh deep) and GoogleTest's sources (libgtest-dev).
# Usage: bash tests/network/aarch64.sh [gtest filter]
set -euo pipefail
cd "$(dirname "$0")/../.."
filter=${1:-*}
build=${THERMORIG_BUILD:-build-aarch64}
mkdir -p "$build"
compiler=aarch64-linux-gnu-g++
launcher=$(command -v ccache || true)
googletest=/usr/src/googletest/googletest
settings=(-std=c++20 -O2 -Wall -Wextra -Wno-missing-field-initializers -Iinclude -Isrc -Isrc/network
  "-DTHERMORIG_SOURCE_DIR=\"$PWD\"" "-ffile-prefix-map=$PWD=.")
# As in src/network/kernels/CMakeLists.txt.
kernel=(-O3 -fno-math-errno -fno-trapping-math -ffp-contract=fast -DTHERMORIG_KERNELS=baseline)

commands=()
compile() { # object, source and options
  local object=$build/$1.o
  shift
  commands+=("$launcher $compiler $(printf '%q ' "$@") -c -o $object")
}
for source in src/network/*.cpp src/core/*.cpp; do
  compile "$(basename "$source" .cpp)" "${settings[@]}" -Werror "$source"
done
for source in src/network/kernels/*.cpp; do
  compile "kernel_$(basename "$source" .cpp)" "${settings[@]}" -Werror "${kernel[@]}" "$source"
done
for source in tests/network/*.cpp; do
  compile "test_$(basename "$source" .cpp)" "${settings[@]}" -Werror "-I$googletest/include" "$source"
done
for source in gtest-all gtest_main; do
  compile "$source" -std=c++20 -O1 "-I$googletest" "-I$googletest/include" "$googletest/src/$source.cc"
done
rm -f "$build"/*.o
printf '%s\0' "${commands[@]}" | xargs -0 -P "$(nproc)" -I{} bash -c '{}'
bash tests/network/kernel_symbols.sh baseline "$build"/kernel_*.o
$compiler -static "$build"/*.o -o "$build/test_network"
qemu-aarch64 "$build/test_network" --gtest_brief=1 --gtest_filter="$filter"
