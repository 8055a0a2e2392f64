#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Errors of the gyro's estimators on 20 simulated rigs a grade and a servo, and what they state of them: RMS error, median
# sigma, share of the errors within three sigmas. Usage: bash tests/bench/estimators.sh [--json] [--build FOLDER]
set -euo pipefail
cd "$(dirname "$0")/../.."
source tests/bench/arguments.sh
take_arguments "" 0 "$@"
require_built test_estimators
results=$(mktemp)
trap 'rm -f "$results"' EXIT
"$program" --gtest_brief=1 --gtest_filter='OfAGyro/StatedSigmas.*' --gtest_output="json:$results" >&2 || failed=yes
/usr/bin/python3 - "$results" "$json" <<'PYTHON'
import json
import sys

results, as_json = json.load(open(sys.argv[1])), sys.argv[2]
rows = []
for test in (test for suite in results["testsuites"] for test in suite["testsuite"]):
    rig = test["name"].split("/")[-1]
    for name in ("gyro", "gyro-rest", "gyro-kalman"):
        for quantity in ("rate", "exposure", "any_rate", "angle"):
            figures = {figure.replace(" ", "_"): float(test[f"{name} {quantity} {figure}"])
                       for figure in ("errors", "rms", "median sigma", "coverage")}
            rows.append({"rig": rig, "estimator": name, "quantity": quantity, **figures})
if as_json:
    print(json.dumps(rows))
else:
    print(f"{'rig':30}{'estimator':13}{'quantity':10}{'errors':>8}{'RMS':>10}{'sigma':>10}{'coverage':>10}")
    for row in rows:
        print(f"{row['rig']:30}{row['estimator']:13}{row['quantity']:10}{row['errors']:8.0f}{row['rms']:10.4f}"
              f"{row['median_sigma']:10.4f}{row['coverage']:10.4f}")
PYTHON
[ -z "${failed:-}" ]
