#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Everything: what CI runs, with the suites that CI leaves out where their folders have not changed. Prints how long each
# part took, and writes the commit of this pass into tests/last_passes.txt and docs/reliability.md, which are then to be
# committed.
# Usage: bash tests/nightly.sh [seconds a fuzzer, default 60]
set -euo pipefail
cd "$(dirname "$0")/.."
source tests/last_pass.sh
[ -z "$(git status --porcelain)" ] || { echo "there are changes that no commit has: a pass could not be named" >&2; exit 2; }
commit=$(git rev-parse HEAD)
export THERMORIG_EVERYTHING=1 THERMORIG_PARTS=${TMPDIR:-/tmp}/thermorig-parts.$$
: >"$THERMORIG_PARTS"
trap 'rm -f "$THERMORIG_PARTS"' EXIT
bash app/setup.sh torch latex package # half a gigabyte: too much for every run
bash tests/run.sh
bash tests/deep.sh "${1:-60}"
source tests/parts.sh
part "packages on a clean Debian" env THERMORIG_BUILD=build THERMORIG_PRESET=developer bash tests/package_test.sh
part "packages for arm64 in an emulator" env THERMORIG_BUILD=build bash tests/package_test.sh --arch arm64
write_last_pass "$commit" "$(date -u +%Y-%m-%d)"
echo "everything passed at $commit; commit tests/last_passes.txt and docs/reliability.md. How long each part took:"
cat "$THERMORIG_PARTS"
