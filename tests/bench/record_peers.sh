#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Bytes -> labelled samples and bytes -> finished session, beside a careful Python recorder (pyserial, numpy, h5py) on the
# same bytes in the same run, and beside the time that compressing the same arrays takes alone. The bytes are those of
# one acquisition of the plan `paper` on the simulated rig.
# Usage: bash tests/bench/record_peers.sh [--json]
set -euo pipefail
cd "$(dirname "$0")/../.."
bash app/setup.sh bench
cmake --preset release -DTHERMORIG_BENCHMARKS=ON >/dev/null
cmake --build --preset release -j "$(nproc)" --target thermorig record_bench >&2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
build/bin/thermorig record --environment garden --simulated=1 --world honest --fast --plan paper --output "$folder" >&2
/usr/bin/python3 tests/bench/record_peers.py build/bin/record_bench "$folder"/garden/*.h5 "$folder" "$@"
