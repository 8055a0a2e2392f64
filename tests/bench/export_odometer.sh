#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The odometer of `thermorig export --odometer`: flash, RAM, stack and instructions a frame on a Cortex-M4F in QEMU, how far its
# heading is from the same C on this machine, from the product's odometer, and from the true shaft of 24 simulated rigs, started
# in motion and at rest. Needs what `bash app/setup.sh deep` installs. --quick: 4 rigs.
# Usage: bash tests/bench/export_odometer.sh [--json] [--first-seed N] [--quick]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target export_odometer >&2
"$build"/bin/export_odometer "$@"
