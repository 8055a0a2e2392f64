#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Every fuzzer for so many seconds, two side by side, from the seeds and what was found before; the corpora are kept small.
# Usage: bash tests/fuzz/run.sh SECONDS BUILD_FOLDER [FUZZER...]
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=$1 build=$2
shift 2
fuzzers=("$@")
if [ ${#fuzzers[@]} = 0 ]; then
  for source in tests/fuzz/*_fuzzer.cpp; do fuzzers+=("$(basename "$source" .cpp)"); done
fi
export UBSAN_OPTIONS=halt_on_error=1
captures=${THERMORIG_CAPTURES:-../shared/captures}

# Text grows deep and long before it does harm; bytes of a device do not.
longest_input() {
  case $1 in
    header_json_* | plan_* | profile_* | result_* | run_* | text_camera_* | text_gyro_* | web_*) echo 65536 ;;
    *) echo 8192 ;;
  esac
}

fuzz() {
  [ "$1" != session_fuzzer ] || export ASAN_OPTIONS=detect_leaks=0 # libhdf5 keeps what it once took
  local name=$1 corpus=$build/corpus/$1 small=$build/corpus/$1.small dictionary=() longest
  longest=$(longest_input "$1")
  mkdir -p "$corpus"
  python3 tests/fuzz/seeds.py "$name" protocols/vectors "$corpus" "$captures"
  [ ! -f "tests/fuzz/${name%_fuzzer}.dict" ] || dictionary=(-dict="tests/fuzz/${name%_fuzzer}.dict")
  if ! "$build/bin/$name" -max_total_time="$seconds" -max_len="$longest" -rss_limit_mb=2048 -timeout=20 -verbosity=0 \
    -print_final_stats=1 -artifact_prefix="$build/" "${dictionary[@]}" "$corpus" >"$build/$name.log" 2>&1; then
    tail -n 40 "$build/$name.log" >&2
    echo "$name: a finding, see above and $build" >&2
    return 1
  fi
  if [ "$(find "$corpus" -type f | wc -l)" -gt 500 ]; then # smaller files that reach the same
    rm -rf "$small" && mkdir "$small"
    "$build/bin/$name" -merge=1 -max_len="$longest" -rss_limit_mb=2048 "$small" "$corpus" >/dev/null 2>&1 &&
      rm -rf "$corpus" && mv "$small" "$corpus"
  fi
  echo "$name: no finding in $seconds s, $(grep -o 'number_of_executed_units: *[0-9]*' "$build/$name.log" |
    grep -o '[0-9]*$') runs, corpus of $(find "$corpus" -type f | wc -l)"
}

failed=0
for ((i = 0; i < ${#fuzzers[@]}; i += 2)); do
  processes=()
  for name in "${fuzzers[@]:i:2}"; do
    fuzz "$name" &
    processes+=($!)
  done
  for process in "${processes[@]}"; do wait "$process" || failed=1; done
done
exit $failed
