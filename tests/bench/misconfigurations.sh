#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Machines and rigs that are wrong in one way each: which of them `thermorig doctor` or the preflight check names.
# Usage: bash tests/bench/misconfigurations.sh [--json] [build folder, default build]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/arguments.sh
json=""
build=build
for word in "$@"; do
  case $word in
    --json) json=yes ;;
    *) build=$word ;;
  esac
done
require_built test_doctor
output=$("$program" --gtest_brief=1 --gtest_filter='Misconfigurations.AreNamedEachOfThem') || failed=yes
if [ -n "$json" ]; then
  printf '%s\n' "$output" | awk '
    / of [0-9]+ misconfigurations are named$/ { named = $1; all = $3 }
    END { printf "{\"misconfigurations\": %d, \"named\": %d}\n", all, named }'
else
  printf '%s\n' "$output"
fi
[ -z "${failed:-}" ]
