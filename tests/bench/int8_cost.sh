#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What int8 weights cost: models are exported as C with float32 and with int8 weights, compiled for this machine with whole-number
# activations as on a board, and fed the frames of sessions one by one. Test MSE of both over all windows, and its change;
# exit code 1 if int8 raises one by more than 5 %.
# Without a SESSION: garden acquisition 6 of the simulated Table I (seed 18, raw gyro), which the models of docs/models never saw.
# Usage: bash tests/bench/int8_cost.sh [--json] [--model MODEL.onnx]... [--train FOLDER] [SESSION.h5...]
#   --model   default: docs/models/best.onnx
#   --train   the other shapes too: trains them (preset best, 40 epochs) on Table I with a raw gyro in FOLDER, which is recorded
#             where it is not there, garden 6 left out, and keeps them in FOLDER/models
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/recordings.sh
json=0 train='' models=() sessions=()
while [ $# -gt 0 ]; do
  case "$1" in
    --json) json=1 ;;
    --model) models+=("$2"); shift ;;
    --train) train=$2; shift ;;
    -*) echo "usage: int8_cost.sh [--json] [--model MODEL.onnx]... [--train FOLDER] [SESSION.h5...]" >&2; exit 2 ;;
    *) sessions+=("$1") ;;
  esac
  shift
done
[ ${#models[@]} -gt 0 ] || models=(docs/models/best.onnx)
thermorig=${THERMORIG_BUILD:-build}/bin/thermorig
[ -x "$thermorig" ] || { echo "build first: bash tests/run.sh (or set THERMORIG_BUILD)" >&2; exit 1; }
thermorig=$(realpath "$thermorig")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

if [ -n "$train" ]; then
  record_table_one raw "$train"
  mkdir -p "$train/models"
  for shape in "nf3_nr2 --nr 2" "nf3_nr3 --nr 3" "nf3_nr1_thermal --thermal-only"; do
    model=$train/models/${shape%% *}.onnx
    # shellcheck disable=SC2086  # options of a shape are words
    [ -f "$model" ] || "$thermorig" train "$train"/{laboratory,dining,kitchen}/*.h5 "$train"/garden/garden_acq-0[1-5]*.h5 \
      --run-folder "$folder/run_${shape%% *}" -o "$model" ${shape#* } >&2
    models+=("$model")
  done
fi
if [ ${#sessions[@]} = 0 ]; then
  record_left_out "$folder"
  sessions=("$folder"/garden/*.h5)
fi

for model in "${models[@]}"; do
  name=$(basename "$model" .onnx)
  for weights in float32 int8; do
    source=$folder/$name/$weights
    "$thermorig" export "$model" --c-header --weights "$weights" --name network -o "$source" >&2
    cc -std=c99 -O2 -I"$source" tests/bench/int8_cost/windows.c "$source/network.c" -lm -o "$source/windows"
  done
done
/usr/bin/python3 tests/bench/int8_cost/compare.py "$json" "$folder" "${sessions[@]}" -- "${models[@]}"
