#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Records the paper's Table I from the simulated rig in virtual time: 18 acquisitions in 4 environments, one seed each,
# plan `table-one`, on all cores. Prints frames by environment and the time that it took.
# Usage: bash tests/bench/table_one.sh [--json] [--keep FOLDER]
set -euo pipefail
cd "$(dirname "$0")/../.."
json=0 keep=
while [ $# -gt 0 ]; do
  case "$1" in
    --json) json=1 ;;
    --keep) keep=$2; shift ;;
    *) echo "usage: table_one.sh [--json] [--keep FOLDER]" >&2; exit 2 ;;
  esac
  shift
done
thermorig=${THERMORIG_BUILD:-build}/bin/thermorig
[ -x "$thermorig" ] || { echo "build first: bash tests/run.sh (or set THERMORIG_BUILD)" >&2; exit 1; }
thermorig=$(realpath "$thermorig")
folder=${keep:-$(mktemp -d)}
[ -n "$keep" ] || trap 'rm -rf "$folder"' EXIT

# The acquisitions of one environment share a folder and so its numbering: one process an environment would leave
# cores idle, so each records to a folder of its own.
jobs() {
  seed=1
  for entry in laboratory:4 dining:4 kitchen:4 garden:6; do
    for acquisition in $(seq "${entry#*:}"); do
      echo "${entry%:*} $seed $acquisition"
      seed=$((seed + 1))
    done
  done
}
start=$(date +%s.%N)
jobs | xargs -P "$(nproc)" -L 1 sh -c '"$0" record --environment "$2" --simulated="$3" --fast --plan table-one \
  --output "$1/acquisition-$4" --json > "$1/$2-$4.log" 2>&1 || { cat "$1/$2-$4.log" >&2; exit 255; }' \
  "$thermorig" "$folder"
seconds=$(awk "BEGIN {print $(date +%s.%N) - $start}")

"$thermorig" inspect --json "$folder"/acquisition-*/*/*.h5 | python3 "$(dirname "$0")/table_one.py" "$json" "$seconds"
