#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Records the paper's Table I from the simulated rig in virtual time: 18 acquisitions in 4 environments, one seed each,
# plan `table-one`, on all cores. Prints frames by environment and the time that it took.
# Usage: bash tests/bench/table_one.sh [--json] [--keep FOLDER] [--gyro KIND]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/recordings.sh
json=0 keep= gyro=typical
while [ $# -gt 0 ]; do
  case "$1" in
    --json) json=1 ;;
    --keep) keep=$2; shift ;;
    --gyro) gyro=$2; shift ;;
    *) echo "usage: table_one.sh [--json] [--keep FOLDER] [--gyro KIND]" >&2; exit 2 ;;
  esac
  shift
done
find_thermorig
folder=${keep:-$(mktemp -d)}
mkdir -p "$folder"
[ -n "$keep" ] || trap 'rm -rf "$folder"' EXIT

# The acquisitions of an environment are numbered in its folder, so they are recorded one after another; environments
# side by side.
start=$(date +%s.%N)
printf '%s\n' garden:13:18 laboratory:1:4 dining:5:8 kitchen:9:12 | xargs -P "$(nproc)" -I{} sh -c '
  thermorig=$1 gyro=$2 folder=$3
  environment=${4%%:*} seeds=${4#*:}
  for seed in $(seq "${seeds%:*}" "${seeds#*:}"); do
    log="$folder/$environment-$seed.log"
    "$thermorig" record --environment "$environment" --simulated="$seed" --fast --plan table-one \
      --simulated-gyro "$gyro" --world honest --licence CC-BY-4.0 --output "$folder" --json > "$log" 2>&1 || { cat "$log" >&2; exit 255; }
  done' record "$thermorig" "$gyro" "$folder" {}
seconds=$(awk "BEGIN {print $(date +%s.%N) - $start}")

"$thermorig" inspect --json "$folder"/*/*.h5 | python3 "$(dirname "$0")/table_one.py" "$json" "$seconds"
