#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# How the odometer does: 24 simulated rigs with a raw gyro (6 gyros x 4 environments, plan "paper"), started in motion, and
# 19 stresses, 24 rigs of the world "typical" after `calibrate lens`, an hour, and 24 lenses, by causal clocks against the
# true shaft; each figure with what it must meet. --quick: 4 rigs, no stress.
# Usage: bash tests/bench/odometer_table.sh [--json] [--first-seed N] [--quick] [--only TEXT]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target odometer_table >&2
"$build"/bin/odometer_table "$@"
