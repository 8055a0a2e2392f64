#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# How many instructions paths take on fixed inputs (tests/bench/costs.cpp), counted by callgrind: the same count whatever else
# the machine does. Held against tests/bench/costs.txt: exit code 1 where one has grown by more than 3 %. Who makes something
# dearer on purpose writes the file anew in the same commit, and says why in its message. Needs what `bash app/setup.sh deep`
# installs, and the programs thermorig and costs.
# Usage: bash tests/bench/costs.sh [--write] [--build FOLDER, default build]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/arguments.sh
ledger=tests/bench/costs.txt write='' build=build
while [ $# -gt 0 ]; do
  case $1 in
    --write) write=yes ;;
    --build)
      [ $# -gt 1 ] || refuse_word "$1"
      build=$2
      shift
      ;;
    *) refuse_word "$1" ;;
  esac
  shift
done
require_built costs
require_built thermorig
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export THERMORIG_COSTS_FOLDER=$folder
# One core: nothing is parted over threads.
count() { taskset -c 0 valgrind --tool=callgrind --callgrind-out-file="$folder/$1" "${@:2}" >"$folder/log" 2>&1 || { tail "$folder/log" >&2; exit 1; }; }
count start_up "$build/bin/thermorig" --version
count paths.%p --instr-atstart=no "$build/bin/costs"

python3 - "$folder" "$ledger" "$write" <<'PYTHON'
import pathlib
import re
import sys

folder, ledger, write = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3] == "yes"
LARGEST_GROWTH = 0.03
counts = {}
for path in folder.glob("*"):
    if path.name.startswith(("start_up", "paths.")):
        text = path.read_text(errors="replace")
        name = re.search(r"^desc: Trigger: Client Request: (\S+)$", text, re.M)
        total = re.search(r"^(?:totals|summary): (\d+)$", text, re.M)
        if total and (name or path.name == "start_up"):
            counts[name[1] if name else "start_up"] = int(total[1])
if write:
    ledger.write_text("".join(f"{name} {count}\n" for name, count in sorted(counts.items())))
    sys.exit()
before = {name: int(count) for name, count in map(str.split, ledger.read_text().splitlines())}
grown = []
for name in sorted(before.keys() | counts.keys()):
    was, now = before.get(name), counts.get(name)
    change = "" if not was or not now else f"{100 * (now / was - 1):+.1f} %"
    print(f"{name:28} {'-' if now is None else f'{now:,}':>16}  {change}")
    if was is None or now is None or now > was * (1 + LARGEST_GROWTH):
        grown.append(name)
if grown:
    sys.exit(f"dearer than in {ledger}, new or gone: {', '.join(grown)}; mend it, or --write it anew and say why in the commit")
PYTHON
