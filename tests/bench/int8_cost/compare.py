# SPDX-License-Identifier: MIT
"""Test errors of networks as C, float32 beside int8. Used by int8_cost.sh.

usage: compare.py AS_JSON FOLDER SESSION... -- MODEL...   (FOLDER/<model>/{float32,int8}/windows are the programs)"""
import json
import os
import subprocess
import sys

import h5py
import numpy

MOST_PERCENT = 5.0


def frames_of(path):
    """What windows.c reads, and the labels, of the valid frames of a session."""
    with h5py.File(path) as session:
        samples = session["samples"]
        run = samples["run"][...]
        valid = run > 0
        rows = samples["frame"][...][valid]
        temperatures = session["camera/temperature"][...][rows].reshape(len(rows), -1)
        begins = numpy.diff(run[valid], prepend=0) != 0
        records = numpy.column_stack([begins, samples["rate_gyro"][...][valid], temperatures])
        simulated = bool(session.attrs["simulated"])
        return records.astype(numpy.float32), samples["rate_commanded"][...][valid], simulated


def means_of_windows(labels, frames):
    """Of the last frames up to each."""
    sums = numpy.convolve(labels.astype(numpy.float64), numpy.ones(frames), "valid")
    return numpy.concatenate([numpy.zeros(frames - 1), sums / frames])


def errors_of(program, sessions):
    """Squared errors over all windows: (windows, 2), fused and thermal, (deg/s)^2."""
    errors = []
    for records, labels, _ in sessions:
        answer = subprocess.run([program], input=records.tobytes(), stdout=subprocess.PIPE, check=True).stdout
        out = numpy.frombuffer(answer, numpy.float32).reshape(-1, 3).astype(numpy.float64)
        full = out[:, 0] > 0
        errors.append((out[full, 1:] - means_of_windows(labels, int(out[:, 0].max()))[full, None]) ** 2)
    return numpy.concatenate(errors)


def row_of(folder, name, sessions):
    float32 = errors_of(os.path.join(folder, name, "float32", "windows"), sessions)
    int8 = errors_of(os.path.join(folder, name, "int8", "windows"), sessions)
    row = {"windows": len(float32)}
    for i, estimate in enumerate(("fusion", "thermal")):
        row[f"{estimate}_rmse_dps"] = float(numpy.sqrt(float32[:, i].mean()))
        row[f"{estimate}_int8_mse_percent"] = float(100.0 * (int8[:, i].mean() / float32[:, i].mean() - 1.0))
    return row


as_json, folder = sys.argv[1] == "1", sys.argv[2]
split = sys.argv.index("--")
sessions = [frames_of(path) for path in sys.argv[3:split]]
names = [os.path.splitext(os.path.basename(path))[0] for path in sys.argv[split + 1:]]
table = {name: row_of(folder, name, sessions) for name in names}
within = all(row[f"{e}_int8_mse_percent"] <= MOST_PERCENT for row in table.values() for e in ("fusion", "thermal"))
simulated = all(session[2] for session in sessions)
if as_json:
    figures = {f"{name}_{key}": round(value, 4) for name, row in table.items() for key, value in row.items()}
    print(json.dumps({"simulated": simulated, **figures, "most_percent": MOST_PERCENT, "within": within}))
else:
    print(f"What int8 costs, {'SIMULATED' if simulated else 'recorded'} sessions: MSE of C with int8 weights against C with float32")
    print(f"{'model':<18} {'windows':>8} {'RMSE float32, fusion / thermal':>32} {'int8, fusion':>13} {'int8, thermal':>14}")
    for name, row in table.items():
        rmse = f"{row['fusion_rmse_dps']:.2f} / {row['thermal_rmse_dps']:.2f} deg/s"
        print(f"{name:<18} {row['windows']:>8} {rmse:>32} {row['fusion_int8_mse_percent']:>+12.2f} % "
              f"{row['thermal_int8_mse_percent']:>+12.2f} %")
    print(f"at most +{MOST_PERCENT:.0f} %: {'met' if within else 'NOT met'}")
sys.exit(0 if within else 1)
