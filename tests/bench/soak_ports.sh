#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Minutes of a live run on the simulated rig's ports, on the wall clock, the plan again and again, with a session kept:
# memory and file handles of the process every ten seconds, from 30 s on. Without the preflight check: the machine may be busy. At the
# end one Ctrl-C; the session must pass its check.
# Usage: bash tests/bench/soak_ports.sh [minutes, default 60] [--json] [--build FOLDER, default build]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/arguments.sh
take_arguments "" 60 "$@"
require_built thermorig
minutes=$number
seconds=$(awk "BEGIN { print int(60 * $minutes) }")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" live --simulated=3 --world honest --plan quick --loop --no-page --record --no-preflight -o "$folder" \
  >"$folder/log.txt" 2>&1 &
process=$!

memory_kb() { awk '/^VmRSS:/ { print $2 }' "/proc/$process/status" 2>/dev/null || echo 0; }
handles() { { find "/proc/$process/fd" -mindepth 1 2>/dev/null || true; } | wc -l; }

sleep 30 # the first sweep has begun, every pool was filled once
before_kb=$(memory_kb)
before_handles=$(handles)
most_kb=$before_kb
begin=$SECONDS
next_line=0
[ -n "$json" ] || echo "minutes  memory    handles"
while [ $((SECONDS - begin)) -lt $((seconds - 30)) ] && kill -0 "$process" 2>/dev/null; do
  kb=$(memory_kb)
  [ "$kb" -gt "$most_kb" ] && most_kb=$kb
  if [ -z "$json" ] && [ $((SECONDS - begin)) -ge $next_line ]; then
    printf '%7d  %5d MB  %7d\n' $(((SECONDS - begin) / 60)) $((kb / 1024)) "$(handles)"
    next_line=$((next_line + 60))
  fi
  sleep 10
done
after_kb=$(memory_kb)
after_handles=$(handles)
kill -INT "$process" 2>/dev/null || echo "it ended by itself: $(tail -n 3 "$folder/log.txt")" >&2
code=0
wait "$process" || code=$?
session=$(find "$folder" -name '*.h5' | head -1)
check=0
"$program" inspect --check "$session" >"$folder/inspect.txt" || check=$?
good=true
[ "$code" -eq 130 ] && [ "$check" -eq 0 ] && [ "$after_handles" -eq "$before_handles" ] &&
  [ "$after_kb" -lt $((before_kb * 12 / 10 + 8192)) ] || good=false
if [ -n "$json" ]; then
  printf '{"minutes": %s, "memory_kb_before": %d, "memory_kb_after": %d, "memory_kb_most": %d, ' \
    "$minutes" "$before_kb" "$after_kb" "$most_kb"
  printf '"handles_before": %d, "handles_after": %d, "exit_code": %d, "inspect_code": %d, "good": %s}\n' \
    "$before_handles" "$after_handles" "$code" "$check" "$good"
else
  echo "memory $((before_kb / 1024)) -> $((after_kb / 1024)) MB, handles $before_handles -> $after_handles," \
    "exit code $code, inspect --check $check"
fi
$good
