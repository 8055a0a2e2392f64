#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The slow checks: all tests under AddressSanitizer and UBSan, the threaded ones under ThreadSanitizer, and each
# fuzzer for a bounded time with the golden vectors as seeds, the live page in a browser, the kernel's usb-serial
# driver in a guest, a study on Slurm, the build of the benchmarks, costs in instructions, and the line coverage of what a
# recording's truth rests on.
# Usage: bash tests/deep.sh [seconds a fuzzer, default 6; a full pass takes 60]
set -euo pipefail
cd "$(dirname "$0")/.."
source tests/parts.sh
source tests/far.sh
fuzz_seconds=${1:-6}
build() { cmake --build --preset "$@" -j "$(nproc)"; }

bash app/setup.sh tests deep bench browser usb

cmake --preset asan
part "build with AddressSanitizer, UBSan and the fuzzers" build asan
part "clang-tidy over what changed" python3 tests/tidy.py build-asan
rm -rf build-asan/coverage && mkdir build-asan/coverage # what is not there gets no counts
# Not what only the release runs: long series, which say how large errors are, and slow tests whose code others run.
part "unit tests with AddressSanitizer and UBSan" ctest --test-dir build-asan --output-on-failure -j "$(nproc)" -LE rig \
  -E "^(Cores/|($(paste -sd'|' tests/release_only.txt))( |/|\$))"
part "line coverage" bash tests/coverage.sh --counted
# Not the drills, which measure how soon the shaft rests: what they run is run on virtual ports.
part "tests on the clock with AddressSanitizer and UBSan" bash tests/wall_clock.sh build-asan -L rig -E Drill

# Exported C on boards in QEMU: what it takes.
build_files=(CMakeLists.txt CMakePresets.json tests/CMakeLists.txt app/setup.sh)
mapfile -t embedded < <(printf '%s\n' {src,include/thermorig}/{core,io/files,network,learning/training})
part cortex_m far cortex_m "${build_files[@]}" "${embedded[@]}" tests/embedded tests/support \
  -- build/bin/test_embedded --gtest_brief=1 --gtest_filter='Cores/*'
part aarch64 far aarch64 app/setup.sh {src,include/thermorig}/{core,network} tests/network \
  -- bash tests/network/aarch64.sh 'Estimator*:BatchEstimator*:*GoldenVectors*:Tensors*:Shape*'

cmake --preset developer -DTHERMORIG_BENCHMARKS=ON # which no test runs: that they can be built at all
part "build of the page, the guest and the benchmarks" build developer --target thermorig usb_guest benchmarks
part "live page in a browser" bash tests/page/run.sh build
# Ports on the kernel's usb-serial driver, plugs pulled and put back.
part usb_guest far usb_guest "${build_files[@]}" {src,include/thermorig}/{core,io} tests/usb -- bash tests/usb/run.sh build

# An array whose tasks share a study; one is killed, two are requeued. It mostly waits, and instructions are counted right
# beside whatever else runs.
slurm_and_costs() {
  bash tests/bench/costs.sh &
  local costs=$! code=0
  bash tests/slurm/run.sh build || code=$?
  wait "$costs" || code=$?
  return "$code"
}
part "slurm, and costs in instructions" slurm_and_costs

cmake --preset tsan
part "build with ThreadSanitizer" build tsan --target test_io test_simulated_ports test_rig test_web_server
part "threads with ThreadSanitizer" bash tests/wall_clock.sh build-tsan \
  -R '^(Loop|Pty|Port|SimulatedPorts|PortRecording|SessionFile|PageServer|RestartedServer|Refusals|PlugOn|FinalisingOn)'

part "fuzzers, $fuzz_seconds s each" bash tests/fuzz/run.sh "$fuzz_seconds" build-asan
