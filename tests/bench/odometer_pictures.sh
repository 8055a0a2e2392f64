#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Draws the pictures of docs/odometer.md from one simulated recording (kitchen, seed 7003, raw gyro, world honest, plan
# "paper"): the map as it grows, innovations, heading errors over time.
# Usage: bash tests/bench/odometer_pictures.sh [--into FOLDER, default docs]
set -euo pipefail
cd "$(dirname "$0")/../.."
into=docs
[ "${1-}" != --into ] || into=$2
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target odometer_pictures >&2
"$build"/bin/odometer_pictures | /usr/bin/python3 tests/bench/odometer_pictures.py "$into"
