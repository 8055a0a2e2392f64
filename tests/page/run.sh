#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The pages in a real browser: the live one on synthetic messages, then on the program itself; a finished session. Screenshots and figures are
# left in <build folder>/page_tests.
# Usage: bash tests/page/run.sh [build folder, default build] [arguments of node --test]
set -euo pipefail
source_folder=$(cd "$(dirname "$0")" && pwd)
build=${1:-$source_folder/../../build}
shift || true
build=$(cd "$build" && pwd)
chromium=${THERMORIG_CHROMIUM:-/usr/bin/chromium}

if [ ! -x "$chromium" ]; then
  echo "Skipped: the tests of the live page need a browser at $chromium (bash app/setup.sh browser installs Debian's chromium)."
  exit 0
fi
if [ ! -f "$build/src/io/web/page/files/page.js" ]; then
  echo "There is no live page in $build: build the target thermorig_web_page first." >&2
  exit 1
fi

work=$build/page_tests
mkdir -p "$work/output"
rm -f "$work"/*.mjs
cp "$source_folder"/*.mjs "$source_folder"/package.json "$source_folder"/package-lock.json "$work"
cd "$work"
if ! cmp -s package-lock.json node_modules/.installed; then
  PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD=1 npm ci --ignore-scripts --no-audit --no-fund --no-update-notifier --prefer-offline --loglevel=error
  cp package-lock.json node_modules/.installed
fi
export THERMORIG_BUILD=$build THERMORIG_SOURCE=$(cd "$source_folder/../.." && pwd) THERMORIG_CHROMIUM=$chromium THERMORIG_PAGE_OUTPUT=$work/output
run() { node --test --test-concurrency=1 --test-reporter=spec "$@"; }
run "$@" ./page_test.mjs ./program_test.mjs ./session_test.mjs
