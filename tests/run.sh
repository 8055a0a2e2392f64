#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The test command: sets up what is missing, builds the release and passes every test.
# Usage: bash tests/run.sh [arguments of ctest, e.g. -L unit]
set -euo pipefail
cd "$(dirname "$0")/.."

bash app/setup.sh tests
cmake --preset developer
cmake --build --preset developer -j "$(nproc)"
ctest --test-dir build --output-on-failure -j "$(nproc)" -LE rig "$@"
bash tests/wall_clock.sh build -L rig "$@"
