#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# From the feed of the chunk that completes a frame to its estimate and the screen's figures: 64 frames/s and 1000 gyro
# samples/s of a simulated rig on USB-CDC (network: Nf 3, Nr 1, fusion), what that costs and whether anything is dropped;
# and resident memory after 1 h and 24 h of virtual time at the default rig's 8 frames/s and 200 samples/s.
# --quick: 30 s, and 2 h. Usage: bash tests/bench/live_latency.sh [--json] [--quick]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target live_latency >&2
"$build"/bin/live_latency "$@"
