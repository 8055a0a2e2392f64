# SPDX-License-Identifier: MIT
# Sourced: what figures of networks rest on, recorded from the simulated rig.

# find_thermorig: thermorig, the path of the program that was built.
find_thermorig() {
  thermorig=${THERMORIG_BUILD:-build}/bin/thermorig
  [ -x "$thermorig" ] || { echo "build first: bash tests/run.sh (or set THERMORIG_BUILD)" >&2; exit 1; }
  thermorig=$(realpath "$thermorig")
}

# record_table_one GYRO FOLDER: the paper's Table I, where the folder is not there yet; it appears when all 18 are in it.
record_table_one() {
  [ ! -d "$2" ] || return 0
  echo "recording 18 acquisitions with a $1 gyro to $2" >&2
  rm -rf "$2.part"
  bash tests/bench/table_one.sh --gyro "$1" --keep "$2.part" >&2
  mv "$2.part" "$2"
}

# record_left_out FOLDER: garden acquisition 6 of it with a raw gyro (seed 18), which the models of docs/models never saw.
record_left_out() {
  "$thermorig" record --environment garden --simulated=18 --world honest --fast --plan table-one --simulated-gyro raw --output "$1" >&2
}
