#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tests on the wall clock, which look at the machine themselves (tests/support/on_the_clock.cpp). Those that fail get a
# second try once all others are done: a shared machine that gives no processor does so for minutes.
# Usage: bash tests/wall_clock.sh BUILD_FOLDER [arguments of ctest]
set -euo pipefail
build=$1
shift
ctest --test-dir "$build" --output-on-failure "$@" && exit
ctest --test-dir "$build" --output-on-failure --rerun-failed --no-tests=error
