#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What each label that can be learnt is worth, against the simulator's truth: 5 rigs of the honest and of the typical
# world, each calibrated and recorded as a user does (hard_case); about 2 minutes on two idle cores.
# --train: also the study's smallest training with each label (Nf 2, Nr 3, 10 epochs) on 5 recordings of each world, and
# the error of the fused speed against the shaft; takes longer.
# Usage: bash tests/bench/label_choice.sh [--json] [--train] [--rigs N] [--first-seed N]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target hard_case thermorig >&2
exec nice -n 19 /usr/bin/python3 tests/bench/label_choice.py "$build"/bin "$@"
