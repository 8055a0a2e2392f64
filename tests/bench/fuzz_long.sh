#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Every fuzzer for many minutes. Usage: bash tests/bench/fuzz_long.sh [minutes a fuzzer, default 10]
set -euo pipefail
cd "$(dirname "$0")/../.."
cmake --preset asan
cmake --build --preset asan -j "$(nproc)" --target fuzzers
bash tests/fuzz/run.sh $((60 * ${1:-10})) build-asan
