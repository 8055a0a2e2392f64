#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# From a fresh clone to a labelled session in one command, without any hardware: installs what is missing, builds,
# records the plan `quick` from the simulated rig and inspects the file.
# Usage: bash app/quickstart.sh [folder for recordings]   (default: recordings/ of the project)
set -euo pipefail
cd "$(dirname "$0")/.."
recordings=${1:-recordings}

bash app/setup.sh
cmake --preset release -DTHERMORIG_TESTS=OFF -B build/quickstart >/dev/null
cmake --build build/quickstart -j "$(nproc)"

thermorig=build/quickstart/bin/thermorig
"$thermorig" record --simulated=3 --environment laboratory --plan quick --output "$recordings"
session=$(ls -t "$recordings"/laboratory/*.h5 | head -n 1)
"$thermorig" inspect "$session"
