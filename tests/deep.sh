#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The slow checks: all tests under AddressSanitizer and UBSan, the threaded ones under ThreadSanitizer, and each
# fuzzer for a bounded time with the golden vectors as seeds, and the live page in a browser.
# Usage: bash tests/deep.sh [seconds a fuzzer, default 20]
set -euo pipefail
cd "$(dirname "$0")/.."
fuzz_seconds=${1:-20}
# --repeat: see tests/run.sh.

bash app/setup.sh tests deep page

echo "== AddressSanitizer and UndefinedBehaviorSanitizer"
cmake --preset asan
cmake --build --preset asan -j "$(nproc)"
# Not the README: its blocks build and run the release again.
ctest --test-dir build-asan --output-on-failure -j "$(nproc)" -LE rig
ctest --test-dir build-asan --output-on-failure -L rig --repeat until-pass:2 -E "^Readme|Drill"
ctest --test-dir build-asan --output-on-failure -L rig -R Drill

echo "== Exported C on Cortex-M boards in QEMU: what it takes"
build-asan/bin/test_embedded --gtest_brief=1 --gtest_filter='Cores/*'

echo "== The network on AArch64, in an emulator"
bash tests/network/aarch64.sh 'Estimator*:BatchEstimator*:*GoldenVectors*:Tensors*:Shape*'

echo "== The live page in a browser"
cmake --preset release -DTHERMORIG_TESTS=ON
cmake --build --preset release -j "$(nproc)" --target thermorig
bash tests/page/run.sh build

echo "== ThreadSanitizer"
cmake --preset tsan
cmake --build --preset tsan -j "$(nproc)" --target test_io test_simulated_ports test_rig test_session test_web_server
ctest --test-dir build-tsan --output-on-failure --repeat until-pass:2 -R '^(Loop|Pty|Port|SimulatedPorts|PortRecording|SessionFile|PageServer|RestartedServer|Refusals)'

echo "== Fuzzers, $fuzz_seconds s each"
cmake --preset fuzz
cmake --build --preset fuzz -j "$(nproc)"
export UBSAN_OPTIONS=halt_on_error=1
for source in tests/fuzz/*_fuzzer.cpp; do
  name=$(basename "$source" .cpp)
  corpus=build-fuzz/corpus/$name
  mkdir -p "$corpus"
  python3 tests/fuzz/seeds.py "$name" protocols/vectors "$corpus"
  "build-fuzz/bin/$name" -max_total_time="$fuzz_seconds" -max_len=8192 -rss_limit_mb=2048 -print_final_stats=0 \
    -verbosity=0 -artifact_prefix=build-fuzz/ "$corpus"
  echo "$name: no finding in $fuzz_seconds s, corpus of $(find "$corpus" -type f | wc -l)"
done
