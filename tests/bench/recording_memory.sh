#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# How much memory a long recording takes, which is built in memory when it ends: peak of the process, and the size of its
# session, of a recording of the default rig in virtual time.
# Usage: bash tests/bench/recording_memory.sh [hours, default 1] [--json] [--build FOLDER, default build]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/arguments.sh
take_arguments "" 1 "$@"
require_built thermorig
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# Two legs of 90 deg/s at 8 frames/s.
frames=$(awk "BEGIN { print int(3600 * $number * 8 / 2) }")
printf 'leg_rates_dps = [90, -90]\nframes_per_leg = %d\nvalid_per_leg = 0\nopening_rest_s = 1\nclosing_rest_s = 1\n' \
  "$frames" >"$folder/long.toml"
python3 - "$program" "$folder" "$number" "$json" <<'PYTHON'
import json
import pathlib
import resource
import subprocess
import sys

program, folder, hours, as_json = sys.argv[1:]
folder = pathlib.Path(folder)
done = subprocess.run([program, "record", "--environment", "long", "--simulated=3", "--world", "honest", "--fast", "--plan", folder / "long.toml",
                       "--output", folder], stdout=subprocess.DEVNULL, check=False)
sessions = list(folder.glob("long/*.h5"))
if done.returncode != 0 or len(sessions) != 1:
    sys.exit(f"the recording ended with {done.returncode}")
figures = {"hours": float(hours), "peak_gb": round(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e6, 3),
           "session_gb": round(sessions[0].stat().st_size / 1e9, 3)}
print(json.dumps(figures) if as_json else
      f"{hours} h: {figures['peak_gb']} GB of memory at most, a session of {figures['session_gb']} GB")
PYTHON
