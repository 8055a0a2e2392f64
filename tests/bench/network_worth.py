# SPDX-License-Identifier: MIT
"""Rows and goals of network_worth.sh. network_worth.py JSON FIRST_SEED FOLDER, with general.json and so on in it."""
import json
import math
import pathlib
import sys

ENVIRONMENTS = ("laboratory", "dining", "kitchen", "garden")
# Thermal RMSE over all rooms and in gardens, deg/s, at most.
THERMAL = {"general": (11.5, 6.0), "refined": (10.5, 5.0), "refined_turned": (9.3, 4.0)}


def rows_of(report):
    rows = {}
    for part in [*report["environments"], {"name": "all", "shaft_errors": report["shaft_errors"], "sigma": report["sigma"]}]:
        row = {who: error["rmse_dps"] for who, error in part["shaft_errors"].items()} | part["sigma"]
        # An estimator that said nothing has no error: not a number, which meets no goal.
        rows[part["name"]] = {who: math.nan if value is None else value for who, value in row.items()}
    return rows


def goals_of(name, rows):
    """Each goal as a sentence, and whether it is met."""
    if name in THERMAL:
        for where, most in zip(("all", "garden"), THERMAL[name]):
            yield f"thermal, {where}: at most {most}", rows[where]["cnn-thermal"] <= most
    if name == "general":
        for where, most in (("all", 7.0), ("garden", 5.0)):
            yield (f"fusion beside any gyro of 10 deg/s, {where}: at most {most}",
                   rows[where]["fusion_rmse_beside_10_dps"] <= most)
    if name.endswith("_turned"):
        return
    for where in ENVIRONMENTS:
        row = rows[where]
        yield (f"fusion at most 1.02 of the Kalman filter's gyro, {where}",
               row["cnn-fusion-kalman"] <= 1.02 * row["gyro-kalman"])
        yield (f"fusion below thermal and 10 deg/s, {where}",
               row["fusion_rmse_beside_10_dps"] < min(row["cnn-thermal"], 10.0))
        yield f"0.62 to 0.75 within one sigma, {where}", 0.62 <= row["within_one"] <= 0.75
        yield f"0.93 within two, {where}", row["within_two"] >= 0.93
        yield f"Kg spreads over 0.4, {where}", row["gain_p95"] - row["gain_p05"] >= 0.4


as_json, first, folder = sys.argv[1] == "1", int(sys.argv[2]), pathlib.Path(sys.argv[3])
reports = {path.stem: rows_of(json.loads(path.read_text())) for path in sorted(folder.glob("*.json"))}
goals = [{"model": name, "goal": goal, "met": bool(met)} for name, rows in reports.items() for goal, met in goals_of(name, rows)]
if as_json:
    for row in (row for rows in reports.values() for row in rows.values()):
        row.update({who: None for who, value in row.items() if math.isnan(value)})
    print(json.dumps({"first_seed": first, "models": reports, "goals": goals}))
    sys.exit()
print(f"SIMULATED rooms from seed {first} on; RMSE against the shaft in deg/s")
print("model           room        thermal  likelihood  fusion  fusion*  raw gyro  gyro-rest  gyro-kalman  its fusion  "
      "1 sigma  2 sigma  Kg 5..95 %")
for name, rows in reports.items():
    for where in (*ENVIRONMENTS, "all"):
        row = rows[where]
        print(f"{name:15} {where:10} {row['cnn-thermal']:8.2f} {row['thermal-likelihood']:11.2f} {row['cnn-fusion']:7.2f} "
              f"{row['fusion_rmse_beside_10_dps']:8.2f} {row['gyro']:9.2f} {row['gyro-rest']:10.2f} "
              f"{row['gyro-kalman']:12.2f} {row['cnn-fusion-kalman']:11.2f} {row['within_one']:8.2f} {row['within_two']:8.2f}  "
              f"{row['gain_p05']:.2f}..{row['gain_p95']:.2f}")
print("* expected RMSE beside a gyro that is off by 10 deg/s")
for goal in goals:
    print(f"{'met    ' if goal['met'] else 'NOT MET'}  {goal['model']}: {goal['goal']}")
