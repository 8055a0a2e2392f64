#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tests on the wall clock, as many at a time as there are cores, for they mostly wait. Nothing is tried again because it
# failed. A run in which the computer stood still is void and repeated (tests/support/void_runs.h): the ledger of such runs
# is printed at the end.
# Usage: bash tests/wall_clock.sh BUILD_FOLDER [arguments of ctest]
set -euo pipefail
build=$1
shift
ledger=$build/Testing/void_runs.txt
mkdir -p "$build/Testing"
rm -f "$ledger.waited"
: >"$ledger"
code=0
ctest --test-dir "$build" --output-on-failure -j "$(nproc)" "$@" || code=$?
echo "void runs: $(grep -c '^run ' "$ledger" || true)"
cat "$ledger"
exit "$code"
