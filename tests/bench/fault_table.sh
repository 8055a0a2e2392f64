#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Faults of the disk while 200 frames are recorded, and while that is recovered: an end or a loss of power after every
# call, errors at some; how many such points there are, and what was left at each (docs/evidence/reliability.md). Every
# hundredth session that was recovered is opened with stock h5py. --quick: every twentieth point.
# Usage: bash tests/bench/fault_table.sh [--json] [--quick] [options of fault_table]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${THERMORIG_BUILD:-build-bench}
words=()
for word in "$@"; do
  case "$word" in
    --quick) words+=(--share 0.05 --error-stride 400 --starts 4) ;;
    *) words+=("$word") ;;
  esac
done
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTHERMORIG_BENCHMARKS=ON >&2
cmake --build "$build" --target fault_table >&2
samples=$(mktemp -d)
trap 'rm -rf "$samples"' EXIT
result=0
"$build"/bin/fault_table --samples "$samples" ${words[@]+"${words[@]}"} || result=$?
if /usr/bin/python3 -c 'import h5py' 2>/dev/null; then
  /usr/bin/python3 tests/bench/fault_table_stock.py "$samples" >&2 || result=1
else
  echo "no stock reader: apt-get install python3-h5py" >&2
fi
exit "$result"
