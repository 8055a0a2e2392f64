#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# How the estimator "thermal-likelihood" does: 24 simulated rigs (6 x 4 environments, world "honest", plan "paper"), windows of
# three frames, by causal clocks against the true shaft, beside the Cramer-Rao bound; each figure with what it must meet.
# Usage: bash tests/bench/thermal_likelihood.sh [--json] [--first-seed N] [--quick]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target thermal_likelihood >&2
"$build"/bin/thermal_likelihood "$@"
