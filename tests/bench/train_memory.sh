#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What a training takes whose frames do not fit in memory: peak of memory, seconds of reading and seconds an epoch, beside the
# same training from memory, and how many different models came out (one, if all is well). In turn, so often as there are rounds: frames in memory;
# those that do not fit in --memory on the disk; the same while the bench makes the system forget what it has kept in memory of
# them, as a machine without memory to spare does. An epoch counts by the fastest of its kind; the first of a run holds the
# averaging of the pixels as well. Processor seconds count all threads: with one (--train "--threads 1") none waits busily. The
# acquisitions are copies of one simulated session of some 2,900 frames that differ in a number. The folder is on a disk:
# --folder, else $TMPDIR or /var/tmp.
# Usage: bash tests/bench/train_memory.sh [acquisitions, default 60] [--memory MB, default 250] [--epochs N, default 2] [--rounds N, default 2] [--train "WORDS", of train, default "--preset paper"] [--json] [--build FOLDER, default build] [--folder FOLDER]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/arguments.sh
parent=${TMPDIR:-/var/tmp} memory=250 epochs=2 rounds=2 train="--preset paper"
words=()
while [ $# -gt 0 ]; do
  case $1 in
    --folder | --memory | --epochs | --rounds | --train)
      [ $# -gt 1 ] || refuse_word "$1"
      case $1 in
        --folder) parent=$2 ;;
        --memory) memory=$2 ;;
        --epochs) epochs=$2 ;;
        --rounds) rounds=$2 ;;
        --train) train=$2 ;;
      esac
      shift
      ;;
    *) words+=("$1") ;;
  esac
  shift
done
take_arguments "" 60 ${words[@]+"${words[@]}"}
require_built thermorig
folder=$(mktemp -d -p "$parent")
trap 'rm -rf "$folder"' EXIT
python3 tests/bench/train_memory.py "$program" "$folder" "$number" "$memory" "$epochs" "$rounds" "$train" "$json"
