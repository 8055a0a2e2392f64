#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What an exported network takes on a Cortex-M4F, M3 and M0+: flash, RAM, stack, and the instructions of a window, counted in
# QEMU. Needs what `bash app/setup.sh deep` installs. Usage: bash tests/bench/export_sizes.sh [build folder, default build]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${1:-build}
[ -x "$build/bin/test_embedded" ] || { echo "build first: bash tests/run.sh" >&2; exit 1; }
"$build/bin/test_embedded" --gtest_brief=1 --gtest_filter='Cores/*' | sed -n '/^Cortex\|FAILED/p'
