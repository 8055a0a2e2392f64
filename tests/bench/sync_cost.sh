#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What each --sync costs on the disk of DIR (default: here): a journal that grows as the default rig lets it, 10 s each.
# --quick: 2 s each. Usage: bash tests/bench/sync_cost.sh [--json] [--quick] [DIR]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target sync_cost >&2
"$build"/bin/sync_cost "$@"
