#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# How well times and labels hold: simulated rigs in virtual time against their truth, ours beside what others do with
# the same bytes, each figure with what it must meet. 25 seeds of 180 s a link and load; --quick: 3 of 60 s.
# --world typical: the same rigs in another world, where nothing is asked of the figures (docs/worlds.md).
# Usage: bash tests/bench/timing_table.sh [--json] [--quick] [--first-seed N] [--world NAME]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target timing_table >&2
"$build"/bin/timing_table "$@"
