#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# kill -9 at seeded random moments of recordings on ports (`thermorig record --simulated`), recovery, and what is left held
# against what read() had returned, which a preloaded ledger knows (tests/acceptance/read_ledger.c). Needs python3-h5py.
# Usage: bash tests/bench/kills.sh [COUNT, default 500] [--sweeping] [--json] [--seed N] [--jobs N]
#   --sweeping  killed only where the recording has a valid frame, so that inspect --check must pass each of them
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target thermorig thermorig-avr servo_firmware read_ledger >&2
exec /usr/bin/python3 tests/bench/kills.py "$build" "$@"
