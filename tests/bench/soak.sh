#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Hours of rig in virtual time with faults at seeded moments: silence, garbage, flipped bits, lost commands, lost
# chunks, plugs pulled and put back. Every session that is written is read and checked; memory and file handles must
# stay flat.
# Usage: bash tests/bench/soak.sh [hours, default 24] [--json] [--build FOLDER, default build]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/arguments.sh
take_arguments "" 24 "$@"
require_built test_soak
export THERMORIG_SOAK_HOURS=$number
if [ -n "$json" ]; then
  "$program" --gtest_brief=1 | grep '^{'
else
  "$program" --gtest_brief=1
fi
