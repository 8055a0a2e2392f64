#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What labels and times are worth in worlds that do the program no favours, and whether it says so: each knob of
# docs/worlds.md at its ends, mixes, and the worlds honest, typical and hard, all against the simulator's truth, with
# what must be met at the end (exit code 1 where it is not). 5 seeds a row, 100 of honest and typical: 585 sessions,
# about half an hour on two idle cores; --quick: one of each.
# Usage: bash tests/bench/hard_table.sh [--json] [--quick] [--first-seed N] [--only KNOB-OR-GLOB] [--typical-seeds N]
#   [--honest-seeds N] [--jobs N] [--sessions FILE]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target hard_case >&2
exec nice -n 19 /usr/bin/python3 tests/bench/hard_table.py "$build"/bin/hard_case "$@"
