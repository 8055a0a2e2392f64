#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Line coverage of the modules that a recording's truth rests on, by their own unit tests, in the build with sanitizers. Fails
# below 95 % of any.
# Usage: bash tests/coverage.sh [--counted] [--missing]   (--counted takes the counts of the last `ctest --test-dir
# build-asan -LE rig` instead of running the tests; --missing lists the lines)
set -euo pipefail
cd "$(dirname "$0")/.."
least=95
modules=(wire sensors timing labels clocks shaft journal session)
missing="" counted=""
build=build-asan
counts=$build/coverage
for word in "$@"; do
  case $word in
    --missing) missing=yes ;;
    --counted) counted=yes ;;
    *) echo "unknown: $word; try: bash tests/coverage.sh [--counted] [--missing]" >&2; exit 2 ;;
  esac
done

# Tests for the release alone are left out: long series, which say how large errors are, and others whose lines are
# run by others.
run_tests() {
  LLVM_PROFILE_FILE="$2/$3-%c%m.profraw" "$1/bin/test_$3" --gtest_brief=1 \
    --gtest_filter="-$(paste -sd: tests/release_only.txt)" >"$2/$3.log" 2>&1 || { cat "$2/$3.log"; return 1; }
}
if [ -z "$counted" ]; then
  bash app/setup.sh tests deep
  cmake --preset asan >/dev/null
  cmake --build --preset asan -j "$(nproc)" --target "${modules[@]/#/test_}"
  rm -rf "$counts"
  mkdir -p "$counts"
  export -f run_tests
  printf '%s\n' "${modules[@]}" | xargs -P "$(nproc)" -I '{}' bash -c 'run_tests "$@"' - "$build" "$counts" '{}'
fi

for module in "${modules[@]}"; do
  # Of a program that was built anew since, the counts are of tests that may be gone.
  find "$counts" -name "$module-*.profraw" ! -newer "$build/bin/test_$module" -delete 2>/dev/null || true
  files=("$counts/$module"-*.profraw)
  [ -e "${files[0]}" ] || { echo "$counts has no counts of $module: run bash tests/coverage.sh" >&2; exit 2; }
  llvm-profdata-14 merge -o "$counts/$module.profdata" "${files[@]}"
  llvm-cov-14 export -format=lcov -instr-profile="$counts/$module.profdata" "$build/bin/test_$module" \
    >"$counts/$module.lcov"
done
# The curve below a clock's inequalities is drawn by live clocks and, over all of them, by the fits of `clocks`; the ledger of
# bytes and packets of a servo's bus are also what the scanners of `sensors` run.
shown=("${modules[@]/%timing/timing+clocks}")
python3 tests/coverage_table.py "$counts" "$least" ${missing:+--missing} "${shown[@]/%wire/wire+sensors}"
