#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Do the tests notice a break? Breaks the program in the 20 places of tests/bench/mutations.jsonl, one at a time, and runs
# what CI runs until a test fails: the module's own tests, the same with sanitizers, all unit tests, those on the clock. Exit code 1 if a break is not found. An entry that cannot be compiled, or changes nothing that anyone could
# see, says so ("left_out"), and the next one drawn takes its place.
# Usage: bash tests/bench/mutations.sh [--json] | --draw SEED   (--draw prints a new list)
set -euo pipefail
cd "$(dirname "$0")/../.."
case ${1-} in
  "" | --json) ;;
  --draw) python3 tests/bench/mutations.py draw "${2:?a seed}" .; exit ;;
  *) echo "unknown: $1; try: bash tests/bench/mutations.sh [--json] | --draw SEED" >&2; exit 2 ;;
esac
list=$PWD/tests/bench/mutations.jsonl
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
git clone -q . "$folder/thermorig"
cd "$folder/thermorig"
python3 tests/bench/mutations.py apply "$list" .
{ cmake --preset developer -DTHERMORIG_WERROR=OFF && cmake --build --preset developer -j "$(nproc)"; } >"$folder/build.log" 2>&1 ||
  { grep -m 20 -A 3 'error' "$folder/build.log" >&2 || tail -n 20 "$folder/build.log" >&2; exit 1; }
python3 tests/bench/mutations.py run "$list" "$PWD" "$PWD/build" ${1-}
