#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The acquisitions of the paper's study (paper_study.sh) once more, for all estimators that need no training, in minutes: by
# causal clocks, against the commanded speed and the true shaft; drift and worst angle from the first word on and from 30 s
# on, failures, coverage, time and memory. --quick: one acquisition an environment.
# Usage: bash tests/bench/study_baselines.sh [--json] [--quick]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target study_baselines >&2
"$build"/bin/study_baselines "$@"
