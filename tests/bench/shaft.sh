#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What a shaft that is measured is worth: labels by the servo model (believed), by an AS5600, a Dynamixel's and an STS3215's
# own sensor, each calibrated in the same world, and by a stepper's (GRBL) commands, against the simulator's truth, in the
# world typical and with backlash, stick-slip, load and a weak supply; what must be met is at the end (exit code 1 where it
# is not). 3 seeds a row, each a calibrated rig and the plan paper: half an hour on two idle cores; --quick: one seed.
# Usage: bash tests/bench/shaft.sh [--json] [--quick] [--first-seed N] [--shafts NAME...] [--jobs N]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target hard_case >&2
exec nice -n 19 /usr/bin/python3 tests/bench/shaft.py "$build"/bin/hard_case "$@"
