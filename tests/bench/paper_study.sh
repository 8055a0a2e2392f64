#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs the study of the paper on the simulated rig: records the paper's 18 acquisitions twice (plan `table-one`, seeds 1 to 18, with a raw and
# with a calibrated gyro), trains and tests (raw: both sweeps; calibrated: Nf = 3 only), keeps the small result files in
# docs/study/{raw,calibrated}/results and writes their tables into docs/paper_study.md. May be stopped at any time: the same
# command goes on and repeats no finished training.
# Usage: bash tests/bench/paper_study.sh [--recordings FOLDER] [--reports FOLDER] [--baselines | --draw]
#   --recordings  where the sessions lie or are recorded to (default build/paper-study)
#   --reports     where report.html and report.json go (default build/paper-study/reports)
#   --baselines   record what is missing, but train nothing: compute the gyro's rows of the result files that there are again.
#                 Recordings that are not those of the results are refused
#   --draw        only draw and write the tables of the result files that there are: records and trains nothing
set -euo pipefail
cd "$(dirname "$0")/../.."
recordings=build/paper-study reports=build/paper-study/reports what=study
while [ $# -gt 0 ]; do
  case "$1" in
    --recordings) recordings=$2; shift ;;
    --reports) reports=$2; shift ;;
    --baselines) what=baselines ;;
    --draw) what=draw ;;
    *) echo "usage: paper_study.sh [--recordings FOLDER] [--reports FOLDER] [--baselines | --draw]" >&2; exit 2 ;;
  esac
  shift
done
thermorig=${THERMORIG_BUILD:-build}/bin/thermorig
[ -x "$thermorig" ] || { echo "build first: bash tests/run.sh (or set THERMORIG_BUILD)" >&2; exit 1; }
thermorig=$(realpath "$thermorig")

# FOLDER appears when all 18 are there.
record() { # GYRO FOLDER
  [ -d "$2" ] && return
  echo "recording 18 acquisitions with a $1 gyro to $2"
  rm -rf "$2.part"
  bash tests/bench/table_one.sh --gyro "$1" --keep "$2.part"
  mv "$2.part" "$2"
}

study() { # GYRO, more options of evaluate
  local gyro=$1
  shift
  "$thermorig" evaluate --study "$recordings/$gyro" -o "docs/study/$gyro" "$@"
}

# Reports are drawn from the result files and never kept beside them.
report() { # GYRO
  [ -d "docs/study/$1/results" ] || return 0
  "$thermorig" evaluate --draw "docs/study/$1" -o "$reports/$1" >/dev/null
  rm -f "docs/study/$1"/report.{md,json,html}
  python3 tests/bench/paper_study_tables.py docs/paper_study.md "$1" "$reports/$1/report.md"
  echo "$1: $reports/$1/report.html"
}

mkdir -p "$recordings" "$reports"
if [ "$what" != draw ]; then
  record raw "$recordings/raw"
  record calibrated "$recordings/calibrated"
fi
case "$what" in
  study)
    study raw
    study calibrated --nf 3 --history 6  # the same end frames as the raw study
    ;;
  baselines)
    study raw --baselines
    study calibrated --baselines
    ;;
esac
report raw
report calibrated
