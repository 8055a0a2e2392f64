#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What ends a run, freezes its host or pulls a cable against the time until the servo's shaft turns slower than 1 deg/s, in the
# micro-controller's time: the largest of several runs.
# Usage: bash tests/bench/drills.sh [--json] [--runs N, default 3] [--build FOLDER, default build]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/arguments.sh
take_arguments --runs 3 "$@"
require_built test_rig
runs=${number%.*}
lines=$(mktemp)
trap 'rm -f "$lines"' EXIT
failed=0
for ((run = 0; run < runs; ++run)); do
  "$program" --gtest_filter='*Drill*' >"$lines.one" || failed=1
  grep '^drill:' "$lines.one" >>"$lines" || true
done
rm -f "$lines.one"
python3 - "$lines" "$json" "$runs" "$failed" <<'PYTHON'
import collections
import json
import sys

lines, as_json, runs, failed = sys.argv[1], sys.argv[2] == "yes", int(sys.argv[3]), sys.argv[4] == "1"
times = collections.defaultdict(list)
for line in open(lines):
    _, command, mishap, ms, _ = line.split()
    times[mishap, command].append(float(ms))
rows = [{"mishap": mishap, "command": command, "runs": len(found), "rest_ms_max": max(found)}
        for (mishap, command), found in sorted(times.items())]
if as_json:
    print(json.dumps({"limit_ms": 300, "passed": not failed, "rows": rows}, indent=1))
else:
    print("| mishap | command | runs | at rest after, at most |\n| --- | --- | ---: | ---: |")
    for row in rows:
        print(f"| {row['mishap']} | {row['command']} | {row['runs']} | {row['rest_ms_max']:.0f} ms |")
    print("\nthe limit is 300 ms: " + ("a drill failed" if failed else "all drills passed"))
PYTHON
exit $failed
