#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Line coverage of the modules that a recording's truth rests on, by their own unit tests. Fails below 95 % of any.
# The counts are those of the last runs of these tests in the build with sanitizers, e.g.
#   ctest --test-dir build-asan -LE rig
# Usage: bash tests/coverage.sh [--missing] [build folder, default build-asan]   (--missing lists the lines)
set -euo pipefail
cd "$(dirname "$0")/.."
least=95
modules=(wire timing labels journal session)
missing=""
build=build-asan
for word in "$@"; do
  case $word in
    --missing) missing=yes ;;
    *) build=$word ;;
  esac
done

for module in "${modules[@]}"; do
  counts=("$build/coverage/$module"-*.profraw)
  [ -e "${counts[0]}" ] || { echo "no counts of $module in $build/coverage: run ctest --test-dir $build -LE rig" >&2; exit 2; }
  llvm-profdata-14 merge -o "$build/coverage/$module.profdata" "${counts[@]}"
  llvm-cov-14 export -format=lcov -instr-profile="$build/coverage/$module.profdata" "$build/bin/test_$module" \
    "src/$module" "include/thermorig/$module" >"$build/coverage/$module.lcov"
done
python3 tests/coverage_table.py "$build/coverage" "$least" ${missing:+--missing} "${modules[@]}"
