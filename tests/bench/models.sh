#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The models of docs/models on garden acquisition 6 of the simulated Table I, which they never saw.
# Usage: bash tests/bench/models.sh [--json | --train | --general]
#   --general  makes docs/models/general-55.onnx and -110.onnx anew, from made-up rooms: some half an hour of one core
#   --train   trains both anew instead, with seed 1, on the acquisitions in build/paper-study/raw, which are recorded where
#             they are not there; the same recordings give the same files on the same instruction set
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/recordings.sh
case ${1-} in "" | --json | --train | --general) ;; *) echo "usage: models.sh [--json | --train | --general]" >&2; exit 2 ;; esac
find_thermorig
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

if [ "${1-}" = --general ]; then
  general() { # LENS EPOCHS: through the narrow lens the images say less, and more epochs helped
    "$thermorig" train --made-rooms --lens "$1" --nf 3 --nr 2 --epochs "$2" --seed 1 -o "$folder/general-$1.onnx"
    mv "$folder/general-$1.onnx" docs/models/
  }
  general 55 500
  general 110 150
  exit
fi
if [ "${1-}" = --train ]; then
  recorded=build/paper-study/raw
  record_table_one raw "$recorded"
  for preset in paper best; do
    "$thermorig" train "$recorded"/{laboratory,dining,kitchen}/*.h5 "$recorded"/garden/garden_acq-0[1-5]*.h5 \
      -o "$folder/$preset.onnx" --preset "$preset"
  done
  mv "$folder"/{paper,best}.onnx docs/models/
  exit
fi
record_left_out "$folder"
reports=()
for model in docs/models/{paper,best}.onnx; do
  report=$folder/$(basename "$model" .onnx).json
  "$thermorig" evaluate "$model" "$folder"/garden/*.h5 --json | tail -n 1 >"$report"
  reports+=("$report")
done
python3 - "${1-}" "${reports[@]}" <<'PYTHON'
import json
import pathlib
import sys

form, *paths = sys.argv[1:]
reports = {pathlib.Path(path).stem: json.loads(pathlib.Path(path).read_text()) for path in paths}
if form == "--json":
    print(json.dumps(reports))
else:
    for name, report in reports.items():
        errors = ", ".join(f"{who} {error['rmse_dps']:.2f}" for who, error in report["errors"].items())
        print(f"{name}: RMSE in deg/s: {errors}; mean Kg {report['gain']['mean']:.3f}")
PYTHON
