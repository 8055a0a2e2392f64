#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The test command: sets up what is missing, builds the release and passes every test.
# Usage: bash tests/run.sh [arguments of ctest, e.g. -L unit]
set -euo pipefail
cd "$(dirname "$0")/.."

bash app/setup.sh tests
cmake --preset release -DTHERMORIG_TESTS=ON
cmake --build --preset release -j "$(nproc)"
# Tests on the wall clock look at the machine (tests/support/on_the_clock.cpp): a failure while it stalls is tried again.
# They get a second try as well, the drills none: a servo that did not stop once is a failure.
ctest --test-dir build --output-on-failure -j "$(nproc)" -LE rig "$@"
ctest --test-dir build --output-on-failure -L rig -E Drill --repeat until-pass:2 "$@"
ctest --test-dir build --output-on-failure -L rig -R Drill "$@"
