#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# How long one training of 40 epochs on 51,561 windows takes on one core (Nf = 3, Nr = 1, fusion): from the measured
# step, and with --full really, by `thermorig train` on the sessions of a folder (the paper's Table I is recorded into it
# where it is not there).
# Usage: bash tests/bench/network_speed.sh [--json] [--full FOLDER]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/recordings.sh
json=() sessions=
while [ $# -gt 0 ]; do
  case "$1" in
    --json) json=(--json) ;;
    --full) sessions=$2; shift ;;
    *) echo "usage: network_speed.sh [--json] [--full FOLDER]" >&2; exit 2 ;;
  esac
  shift
done
bash app/setup.sh bench >&2
build=${THERMORIG_BUILD:-build-bench}
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" -j "$(nproc)" --target thermorig network_interop network_peer_ours >&2
if [ -n "$sessions" ]; then
  THERMORIG_BUILD=$build record_table_one raw "$sessions"
  sessions=$(realpath "$sessions")
fi
taskset -c "$(($(nproc) - 1))" /usr/bin/python3 tests/bench/network_peers/speed.py "$build/bin" "$sessions" "${json[@]}"
