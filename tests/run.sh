#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The test command: sets up what is missing, builds the release with warnings as errors and passes all tests but those of
# boards in QEMU, which tests/deep.sh runs where it may have changed.
# Usage: bash tests/run.sh [arguments of ctest, e.g. -L unit]
set -euo pipefail
cd "$(dirname "$0")/.."
source tests/parts.sh

bash app/setup.sh tests
cmake --preset developer
part "build of the release" cmake --build --preset developer -j "$(nproc)"
part "unit tests" ctest --test-dir build --output-on-failure -j "$(nproc)" -LE rig -E '^Cores/' "$@"
part "tests on the clock" bash tests/wall_clock.sh build -L rig "$@"
