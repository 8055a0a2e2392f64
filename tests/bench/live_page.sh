#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The live page in a browser: bytes of all its files, gzipped, and the time to its first paint (five loads; a run of 400
# frames behind it). Needs what `bash app/setup.sh browser` installs.
# Usage: bash tests/bench/live_page.sh [--json] [--build FOLDER, default build]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/arguments.sh
take_arguments --none "" "$@"
output=$(THERMORIG_FIGURES=1 bash tests/page/run.sh "$build" --test-name-pattern='packed|first paint')
figure() { sed -nE "s/.*$1.*/\1/p" <<<"$output"; }
gzip=$(figure 'page, gzip: ([0-9]+) bytes') median=$(figure 'paint, ms: median ([0-9]+)') greatest=$(figure 'paint, ms: .* greatest ([0-9]+)')
if [ -z "$gzip" ] || [ -z "$greatest" ]; then
  echo "$output" >&2
  exit 1
fi
if [ -n "$json" ]; then
  echo "{\"page_gzip_bytes\": $gzip, \"first_paint_median_ms\": $median, \"first_paint_max_ms\": $greatest}"
else
  printf '%-21s %s\n' page_gzip_bytes "$gzip" first_paint_median_ms "$median" first_paint_max_ms "$greatest"
fi
