#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What a long recording takes: peak of memory and seconds of recording it in virtual time (and so of finalising it), of
# recovering its journal, of inspecting, exporting and reprocessing the session, and how soon `view` shows it. Memory is
# that of the program and its child processes together, with files that lie in memory; "held" is what the system cannot take
# back, which is all but mapped pages of files on disks. Simulated rig, 8 frames/s, 200 gyro samples/s. The folder is on a
# disk: --folder, else $TMPDIR or /var/tmp.
# Usage: bash tests/bench/long_session.sh [hours, default 24] [--json] [--build FOLDER, default build] [--folder FOLDER]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/arguments.sh
folder=${TMPDIR:-/var/tmp}
take_options folder "$@"
take_arguments "" 24 ${words[@]+"${words[@]}"}
require_built thermorig
folder=$(mktemp -d -p "$folder")
trap 'rm -rf "$folder"' EXIT
python3 tests/bench/long_session.py "$program" "$folder" "$number" "$json"
