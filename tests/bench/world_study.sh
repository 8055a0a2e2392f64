#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What networks and gyros make of the honest and of the typical world: a few rigs of each are recorded (garden), and a
# small study (Nf 2, Nr 3) with each preset leaves each recording out once. RMSE against what the session says that the
# shaft did (rate_shaft), median over the folds, of every estimator. Rigs that the check before a recording refuses are
# left out, and the next seed taken.
# Usage: bash tests/bench/world_study.sh [--json] [--rigs N] [--plan NAME] [--epochs N] [--first-seed N]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target thermorig >&2
exec nice -n 19 /usr/bin/python3 tests/bench/world_study.py "$build"/bin "$@"
