#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Makes the figures in the documents anew, by the marks that they carry (tests/bench/table_marks.py). What is between the
# marks of a table is replaced, and its commit. Sentences with figures are for people: what their scripts print is kept in
# build/tables, and it is said which sentence to look at. Whatever fails leaves its table as it was; exit code 1 then.
# Refused while program or tests differ from their commit: no table could name it. All of it takes many hours, mostly of
# fuzzers and soaks; --list says which there are.
# Usage: bash tests/bench/all_tables.sh [--list] [--train] [NAME...]
#   --train   also what trains networks (models, study): recordings and trainings of hours, under build/paper-study, where
#             what was recorded and trained before goes first
#   NAME      these alone, whether they train or not
set -euo pipefail
cd "$(dirname "$0")/../.."
exec python3 tests/bench/all_tables.py "$@"
