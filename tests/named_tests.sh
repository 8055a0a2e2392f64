#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Every line of on_the_clock.txt and release_only.txt names a test that there is: a test that was renamed would else move
# into another suite without a word.
# Usage: named_tests.sh BUILD_FOLDER
set -euo pipefail
tests=$(ctest --test-dir "$1" -N | sed -nE 's/^ *Test +#[0-9]+: //p')
cd "$(dirname "$0")"
failed=0
for list in on_the_clock.txt release_only.txt; do
  while read -r pattern; do
    regex=$(sed -e 's/[.]/\\./g' -e 's/[*]/.*/g' <<<"$pattern")
    grep -qE "^$regex( |/|\$)" <<<"$tests" || { echo "$list: no test has the name $pattern" >&2; failed=1; }
  done <"$list"
done
exit $failed
