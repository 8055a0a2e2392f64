#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What a training takes whose frames do not fit in memory: peak of memory, seconds of reading and seconds an epoch, beside
# the same training from memory, and how many different models came out (one, if all is well). Each round trains with frames
# in memory; with those that do not fit in --memory on the disk; and the same while the bench makes the system forget what it
# has kept of them in memory, as a machine without memory to spare does. An epoch counts by the fastest of its kind; the
# first of a run holds the averaging of the pixels as well. Processor seconds count all threads: with one (--train
# "--threads 1") none waits busily. The acquisitions (60) are copies of one simulated session of some 2,900 frames that
# differ in a number. --memory in MB (250), --epochs (2), --rounds (2), --train: words for train ("--preset paper"),
# --folder: on a disk, else $TMPDIR or /var/tmp.
# Usage: bash tests/bench/train_memory.sh [acquisitions] [--memory MB] [--epochs N] [--rounds N] [--train WORDS] [--json] [--build FOLDER] [--folder FOLDER]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/arguments.sh
folder=${TMPDIR:-/var/tmp} memory=250 epochs=2 rounds=2 train="--preset paper"
take_options "folder memory epochs rounds train" "$@"
take_arguments "" 60 ${words[@]+"${words[@]}"}
require_built thermorig
folder=$(mktemp -d -p "$folder")
trap 'rm -rf "$folder"' EXIT
python3 tests/bench/train_memory.py "$program" "$folder" "$number" "$memory" "$epochs" "$rounds" "$train" "$json"
