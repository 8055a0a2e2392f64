#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What a real camera's bytes say of "thermal-likelihood", without a truth: how often its even and its odd chess halves, each
# alone, tell the same rate, and the bytes forward and reversed. The bytes are no part of this project.
# Usage: bash tests/bench/halves_alone.sh [--json] [--capture FILE] [--rate FRAMES_A_SECOND]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/arguments.sh
capture=${THERMORIG_CAPTURES:-../shared/captures}/gy_mcu90640_serial/roasted-duck.bin
rate=4
take_options "capture rate" "$@"
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target halves_alone >&2
"$build"/bin/halves_alone "$capture" "$rate" "${words[@]}"
