#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What a camera's own words are worth: the same rigs in the world `typical` with each kind of camera, calibrated and
# recorded as a user does, their times and labels against the simulator's truth. 10 seeds, --quick: 2.
# Usage: bash tests/bench/raw_camera.sh [--json] [--quick] [--seeds N] [--first-seed N] [--world NAME] [--jobs N]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target hard_case >&2
exec nice -n 19 /usr/bin/python3 tests/bench/raw_camera.py "$build"/bin/hard_case "$@"
