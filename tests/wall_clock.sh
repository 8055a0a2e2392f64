#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tests on the wall clock, which look at the machine themselves (tests/support/on_the_clock.cpp). As many at a time as
# there are cores, for they mostly wait. Those that fail get a second try, one after the other, once all others are
# done: a shared machine that gives no processor does so for minutes. Crashes, what a sanitizer finds, and a servo that
# did not rest or left its limits once get none.
# Usage: bash tests/wall_clock.sh BUILD_FOLDER [arguments of ctest]
set -euo pipefail
build=$1
shift
run() { ctest --test-dir "$build" --output-on-failure "$@"; }
run -j "$(nproc)" "$@" && exit
if grep -q 'NO SECOND TRY$' "$build/Testing/Temporary/LastTest.log"; then
  echo "One of these failures counts at once: NO SECOND TRY stands in its output." >&2
  exit 1
fi
"$build/bin/on_the_clock"  # until the machine is quiet
# The same arguments again: ctest keeps what failed by number, and its -E shifts the numbers.
run -j 1 "$@" --rerun-failed --no-tests=error
