#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs the study of the paper on the simulated rig: records the paper's 18 acquisitions twice (plan `table-one`, seeds 1 to 18, with a raw and
# with a calibrated gyro), trains and tests (raw: both sweeps; calibrated: Nf = 3 only), keeps the small result files in
# docs/study/{raw,calibrated}/results and draws their reports; `figures.sh study_raw study_calibrated` puts the tables
# into docs/evidence/paper_study.md. May be stopped at any time: the same command goes on and repeats no finished training.
# Usage: bash tests/bench/paper_study.sh [--recordings FOLDER] [--reports FOLDER] [--anew | --baselines | --draw GYRO]
#   --recordings  where the sessions lie or are recorded to (default build/paper-study)
#   --reports     where report.html and report.json go (default build/paper-study/reports)
#   --baselines   record what is missing, but train nothing: compute the gyro's rows of the result files that there are again.
#                 Recordings that are not those of the results are refused
#   --anew        without the result files and recordings that there are (after a stop, go on without this word)
#   --draw        only draw the report of the result files that there are, raw or calibrated, and print its tables as
#                 Markdown: records and trains nothing
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/recordings.sh
recordings=build/paper-study reports=build/paper-study/reports what=study
usage() {
  echo "usage: paper_study.sh [--recordings FOLDER] [--reports FOLDER] [--anew | --baselines | --draw GYRO]" >&2
  exit 2
}
while [ $# -gt 0 ]; do
  case "$1" in
    --recordings) recordings=$2; shift ;;
    --reports) reports=$2; shift ;;
    --baselines) what=baselines ;;
    --anew) what=anew ;;
    --draw)
      what=draw drawn=${2-}
      [ -d "docs/study/$drawn/results" ] || usage
      shift
      ;;
    *) usage ;;
  esac
  shift
done
find_thermorig

study() { # GYRO, more options of evaluate
  local gyro=$1
  shift
  "$thermorig" evaluate --study "$recordings/$gyro" -o "docs/study/$gyro" "$@"
}

# Reports are drawn from the result files and never kept beside them.
report() { # GYRO
  "$thermorig" evaluate --draw "docs/study/$1" -o "$reports/$1" >/dev/null
  rm -f "docs/study/$1"/report.{md,json,html}
  echo "$1: $reports/$1/report.html" >&2
}

mkdir -p "$recordings" "$reports"
if [ "$what" = draw ]; then
  report "$drawn"
  cat "$reports/$drawn/report.md"
  exit
fi
if [ "$what" = anew ]; then
  rm -rf "$recordings"/{raw,calibrated} docs/study/{raw,calibrated}/results
  what=study
fi
record_table_one raw "$recordings/raw"
record_table_one calibrated "$recordings/calibrated"
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
