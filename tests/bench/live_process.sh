#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What `thermorig live` costs as a process, with page and --record, at 64 frames/s and 1000 gyro samples/s: share of a core
# (start and finalising left out), resident memory after the first 10 s and at the end, what was dropped or lost. The rig is
# simulated on ports by another process. Usage: bash tests/bench/live_process.sh [--json] [--seconds N]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target thermorig fast_rig_server >&2
exec python3 tests/bench/live_process.py "$build"/bin/thermorig "$build"/bin/fast_rig_server docs/models/best.onnx "$@"
