#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# app/quickstart.sh and app/setup.sh as strangers meet them, without installing or building anything.
# Usage: bash tests/quickstart_test.sh PROGRAM
set -euo pipefail
program=$(realpath "$1")
cd "$(dirname "$0")/.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder/build/bin" "$folder/tools"

tool() { # name, script
  printf '#!/bin/bash\n%s\n' "$2" >"$folder/tools/$1"
  chmod +x "$folder/tools/$1"
}
fails() { # what it ought to say, words of the command
  local said status=0
  said=$("${@:2}" 2>&1) || status=$?
  [ "$status" -ne 0 ] && grep -q "$1" <<<"$said" || { echo "not refused with '$1' ($status): $said"; exit 1; }
  [ "$(tail -n 1 <<<"$said" | grep -c 'apt-get install .*cmake')" -eq 1 ] || { echo "no advice: $said"; exit 1; }
}

# A folder of many sessions, newer than the one that is recorded now.
tool cmake :
tool dpkg-query 'echo install ok installed'
printf '#!/bin/bash\n[ "$1" = record ] && set -- "$@" --fast --speeds 40 --frames-per-leg 12\nexec %q "$@"\n' "$program" \
  >"$folder/build/bin/thermorig"
chmod +x "$folder/build/bin/thermorig"
mkdir -p "$folder/my recordings/laboratory"
(cd "$folder/my recordings/laboratory" && touch -d '2099-01-01' others-with-names-that-are-long-{0001..2500}.h5)
PATH="$folder/tools:$PATH" THERMORIG_BUILD="$folder/build" bash app/quickstart.sh "$folder/my recordings" \
  >"$folder/out" 2>"$folder/err" || { cat "$folder/err"; exit 1; }
grep -q "laboratory_acq-01_.*\.h5" "$folder/out" && grep -q '^verdict ' "$folder/out" ||
  { echo "did not inspect its own session:"; cat "$folder/out" "$folder/err"; exit 1; }

# No rights, no network. Nothing but these tools is found.
for name in bash grep cat tail; do ln -s "$(command -v "$name")" "$folder/tools/"; done
tool dpkg-query 'exit 1'
tool npm :
tool apt-get 'echo "E: Unable to locate package" >&2; exit 100'
tool id 'echo 1000'
fails 'there is no sudo' env PATH="$folder/tools" bash app/setup.sh
tool sudo '"$@"'
fails 'apt-get update failed' env PATH="$folder/tools" bash app/setup.sh
tool id 'echo 0'
tool apt-get '[ "$1" = update ]'
fails 'apt-get install failed' env PATH="$folder/tools" bash app/setup.sh
