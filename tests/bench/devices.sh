#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Whether the program reads what devices send that somebody may own: cameras and gyros as published sketches, bridges and
# documents have them, with made-up values. Each whole, in pieces of every size, behind garbage and joined in the middle; or
# refused, with the right reason. No port is opened. Exit code 1 where fewer than 95 % are right, or one is silently wrong.
# Usage: bash tests/bench/devices.sh [--json] [--build FOLDER, default build]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/arguments.sh
take_arguments "" 0 "$@"
require_built devices
"$program" ${json:+--json}
