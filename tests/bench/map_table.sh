#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Sessions that begin with the map of an earlier one (live --map): 24 simulated rooms, each again, from rest and in motion,
# with another bias of the gyro; the same in the world "typical", after `calibrate lens`; and the map of each honest room in
# the 23 others. How soon the heading is known, how wrong it is, and
# how often another room is taken for the same.
# Usage: bash tests/bench/map_table.sh [--json] [--first-seed N]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target map_table >&2
"$build"/bin/map_table "$@"
