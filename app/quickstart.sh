#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# From a fresh clone to a labelled session in one command, without any hardware: installs what is missing, builds,
# records the plan `quick` from the simulated rig and inspects the file.
# Usage: bash app/quickstart.sh [folder for recordings]   (default: recordings/ of the project)
# THERMORIG_BUILD names another build folder than build/, THERMORIG_PRESET another preset than release.
set -euo pipefail
cd "$(dirname "$0")/.."
recordings=${1:-recordings}
build=${THERMORIG_BUILD:-build}

bash app/setup.sh
cmake --preset "${THERMORIG_PRESET:-release}" -B "$build" -DTHERMORIG_TESTS=OFF >/dev/null
cmake --build "$build" -j "$(nproc)"

# Its own session, whatever else lies there: the one that it names. What it prints is seen as well.
session=$("$build"/bin/thermorig record --simulated=4 --environment laboratory --plan quick --output "$recordings" |
  tee >(cat >&2) | sed -n 's/^session  *//p')
"$build"/bin/thermorig inspect "$recordings/laboratory/$(basename "$session")"
