#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A data set as one publishes it, of the simulated rig: records the paper's Table I (table_one.sh) into FOLDER unless it is
# there, builds the data set, verifies it, verifies it with one byte flipped, and prints how long each takes.
# Usage: bash tests/bench/dataset_example.sh FOLDER
set -euo pipefail
folder=$(realpath -m "$1")
cd "$(dirname "$0")/../.."
thermorig=$(realpath "${THERMORIG_BUILD:-build}/bin/thermorig")
[ -d "$folder" ] || bash tests/bench/table_one.sh --keep "$folder"

took() { # WORD COMMAND...: seconds behind what it prints
  local begin word=$1
  shift
  begin=$(date +%s.%N)
  "$@"
  awk "BEGIN {printf \"$word: %.2f s\n\n\", $(date +%s.%N) - $begin}"
}

took list "$thermorig" list "$folder"
took build "$thermorig" dataset build "$folder" --title "Table I, simulated" --author "The thermorig authors" --replace
took verify "$thermorig" dataset verify "$folder"

session=$(find "$folder" -name '*.h5' | sort | head -n 1)
flip() { # a byte in the middle of the session
  python3 - "$session" <<'PYTHON'
import sys
with open(sys.argv[1], "r+b") as file:
    middle = file.seek(0, 2) // 2
    file.seek(middle)
    byte = file.read(1)
    file.seek(middle)
    file.write(bytes([byte[0] ^ 1]))
PYTHON
}
flip
code=0
"$thermorig" dataset verify "$folder" || code=$?
flip
[ "$code" -eq 9 ] || { echo "verify gave $code for a flipped byte, and not 9" >&2; exit 1; }
"$thermorig" dataset verify "$folder"
