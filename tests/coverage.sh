#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Line coverage of the modules that a recording's truth rests on, by their own unit tests. Fails below 95 % of any.
# Usage: bash tests/coverage.sh [--missing] [build folder, default build-coverage]   (--missing lists the lines)
set -euo pipefail
cd "$(dirname "$0")/.."
least=95
modules=(timing labels session wire journal) # the longest first
missing=""
build=build-coverage
for word in "$@"; do
  case $word in
    --missing) missing=yes ;;
    *) build=$word ;;
  esac
done

bash app/setup.sh tests coverage
cmake --preset coverage -B "$build" >/dev/null
cmake --build "$build" -j "$(nproc)" --target "${modules[@]/#/test_}"

# Long series of recordings are left out: what they say of the size of errors is for the release, and the lines are
# run by others. Without optimisation these took half of the time.
series=$(paste -sd: tests/long_series.txt)
find "$build" -name '*.gcda' -delete
# As many at a time as there are cores; what they count of libraries in common is added up under a lock.
run_tests() {
  "$1/bin/test_$3" --gtest_brief=1 --gtest_filter="-$2" >"$1/test_$3.log" 2>&1 || { cat "$1/test_$3.log"; return 1; }
}
export -f run_tests
printf '%s\n' "${modules[@]}" | xargs -P "$(nproc)" -I '{}' bash -c 'run_tests "$@"' - "$build" "$series" '{}'

filters=()
objects=()
for module in "${modules[@]}"; do
  filters+=(--filter "src/$module/" --filter "include/thermorig/$module/")
  objects+=("$build/CMakeFiles/thermorig_$module.dir" "$build/tests/CMakeFiles/test_$module.dir")
done
# These two run in the child that reads hostile files, which may open no file to write its counts into: their tests look
# at what the child may do.
gcovr --root . --object-directory "$build" "${filters[@]}" --exclude 'src/session/(cage|call_filter)\.cpp' --json "$build/coverage.json" -j "$(nproc)" "${objects[@]}"
python3 tests/coverage_table.py "$build/coverage.json" "$least" ${missing:+--missing} "${modules[@]}"
