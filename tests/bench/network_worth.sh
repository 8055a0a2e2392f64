#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What the general model is worth in rooms that it has never seen, and with --refined one that `train` has made of it and
# of 17 recordings: simulated rooms, world honest unless another is named, raw gyro, plan table-one, errors against the
# shaft. Says of each goal whether it is met.
# Usage: bash tests/bench/network_worth.sh [--json] [--first-seed N] [--rooms N] [--lens 55|110] [--world W] [--refined]
#   --first-seed   of the rooms (1001); choose one that nobody has looked at
#   --rooms        an environment (2)
#   --refined      also records the 18 acquisitions of Table I in build/paper-study/raw, where they are not there, and
#                  trains on those but garden 6
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/recordings.sh
json=0 first=1001 rooms=2 refined=0 lens=55 world=honest
while [ $# -gt 0 ]; do
  case "$1" in
    --json) json=1 ;;
    --first-seed) first=$2; shift ;;
    --rooms) rooms=$2; shift ;;
    --lens) lens=$2; shift ;;
    --world) world=$2; shift ;;
    --refined) refined=1 ;;
    *) echo "usage: network_worth.sh [--json] [--first-seed N] [--rooms N] [--lens 55|110] [--world W] [--refined]" >&2; exit 2 ;;
  esac
  shift
done
find_thermorig
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

printf '[camera]\nfield_of_view_deg = %s.0\n' "$lens" >"$folder/rig.toml"
seed=$first
for environment in laboratory dining kitchen garden; do
  for _ in $(seq "$rooms"); do
    echo "recording $environment, seed $seed" >&2
    "$thermorig" record --environment "$environment" --simulated="$seed" --rig "$folder/rig.toml" --world "$world" --fast \
      --plan table-one \
      --simulated-gyro raw --output "$folder/rooms" --json >"$folder/record.log" 2>&1 || [ $? -eq 3 ] || { cat "$folder/record.log" >&2; exit 1; } # 3: with losses
    seed=$((seed + 1))
  done
done

evaluate() { # NAME MODEL TURNED
  echo "evaluating $1" >&2
  "$thermorig" evaluate "$2" "$folder/rooms" --turned "$3" --json | tail -n 1 >"$folder/$1.json"
}
evaluate general general 1
evaluate general_turned general 8
if [ "$refined" = 1 ]; then
  recorded=build/paper-study/raw
  record_table_one raw "$recorded"
  "$thermorig" train "$recorded"/{laboratory,dining,kitchen}/*.h5 "$recorded"/garden/garden_acq-0[1-5]*.h5 \
    --label shaft -o "$folder/refined.onnx" >&2
  evaluate refined "$folder/refined.onnx" 1
  evaluate refined_turned "$folder/refined.onnx" 8
fi
python3 tests/bench/network_worth.py "$json" "$first" "$folder"
