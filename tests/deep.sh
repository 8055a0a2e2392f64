#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The slow checks: all tests under AddressSanitizer and UBSan, the threaded ones under ThreadSanitizer, and each
# fuzzer for a bounded time with the golden vectors as seeds, the live page in a browser, the kernel's usb-serial
# driver in a guest, and the line coverage of what a recording's truth rests on.
# Usage: bash tests/deep.sh [seconds a fuzzer, default 20]
set -euo pipefail
cd "$(dirname "$0")/.."
fuzz_seconds=${1:-20}

bash app/setup.sh tests deep browser usb coverage

echo "== AddressSanitizer and UndefinedBehaviorSanitizer"
cmake --preset asan
cmake --build --preset asan -j "$(nproc)"
# Not the long series, which say how large errors are: their lines are run by others.
ctest --test-dir build-asan --output-on-failure -j "$(nproc)" -LE rig -E "^($(paste -sd'|' tests/long_series.txt))"
# Not the README: its blocks build and run the release again.
bash tests/wall_clock.sh build-asan -L rig -E "^Readme"

echo "== Exported C on Cortex-M boards in QEMU: what it takes"
build-asan/bin/test_embedded --gtest_brief=1 --gtest_filter='Cores/*'

echo "== The network on AArch64, in an emulator"
bash tests/network/aarch64.sh 'Estimator*:BatchEstimator*:*GoldenVectors*:Tensors*:Shape*'

echo "== The live page in a browser"
cmake --preset developer
cmake --build --preset developer -j "$(nproc)" --target thermorig usb_guest
bash tests/page/run.sh build

echo "== Ports on the kernel's usb-serial driver, plugs pulled and put back"
bash tests/usb/run.sh build

echo "== ThreadSanitizer"
cmake --preset tsan
cmake --build --preset tsan -j "$(nproc)" --target test_io test_simulated_ports test_rig test_session test_web_server
bash tests/wall_clock.sh build-tsan -R '^(Loop|Pty|Port|SimulatedPorts|PortRecording|SessionFile|PageServer|RestartedServer|Refusals)'

echo "== Line coverage"
bash tests/coverage.sh

echo "== Fuzzers, $fuzz_seconds s each"
cmake --preset fuzz
cmake --build --preset fuzz -j "$(nproc)"
bash tests/fuzz/run.sh "$fuzz_seconds" build-fuzz
