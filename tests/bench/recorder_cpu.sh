#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# How much of a core the recorder uses at 8 frames/s and 200 gyro samples/s: `thermorig simulate` serves three ports in one
# process, `thermorig record` records them in another, whose CPU time the kernel counts (start and finalising included).
# Usage: bash tests/bench/recorder_cpu.sh [--json]
set -euo pipefail
cd "$(dirname "$0")/../.."
thermorig=${THERMORIG_BUILD:-build}/bin/thermorig
[ -x "$thermorig" ] || { echo "build first: bash tests/run.sh (or set THERMORIG_BUILD)" >&2; exit 1; }
exec python3 tests/bench/recorder_cpu.py "$thermorig" "$@"
