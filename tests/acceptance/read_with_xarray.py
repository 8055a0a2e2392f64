# SPDX-License-Identifier: MIT
"""Opens every group of a session in xarray: named dimensions, coordinates, units, nothing made up.

usage: read_with_xarray.py FILE    exit code 0: all well; else a sentence for each deviation"""
import sys
import warnings

import xarray

GROUPS = {"camera": {"time", "row", "column", "half"}, "gyro": {"time", "axis"}, "servo": {"time", "step_leg", "command_time"}, "sync": {"knot", "speed", "bias_time", "ripple_period"},
          "sync/servo": {"time", "knot_time", "epoch_begin", "gap_begin"},
          "samples": {"time", "half"}, "events": {"time"}, "quality": {"speed"}, "raw/camera": {"byte", "chunk"},
          "raw/gyro": {"byte", "chunk"}, "raw/servo": {"byte", "chunk"}, "raw/sent": {"byte", "chunk"}}
AXES_WITHOUT_VALUES = {"byte", "chunk", "knot"}


def check_group(path, group, expected):
    with xarray.open_dataset(path, engine="h5netcdf", group=group) as data:
        data.load()
        if set(data.dims) != expected:
            yield f"{group} has the dimensions {sorted(data.dims)}, not {sorted(expected)}"
        for name in expected - AXES_WITHOUT_VALUES:
            if name not in data.coords:
                yield f"{group} has no coordinate {name}"
        for name, variable in data.variables.items():
            if not variable.attrs.get("units") or not variable.attrs.get("long_name"):
                yield f"{group}/{name} has no unit or no name"


def check_use(path):
    """What a person does first: valid labels against the gyro, a frame by its place and time."""
    with xarray.open_dataset(path, engine="h5netcdf", group="samples") as samples:
        valid = samples.where(samples.valid == 1, drop=True)
        if valid.sizes["time"] == 0 or float(abs(valid.rate_shaft - valid.rate_gyro).median()) > 10:
            yield "valid labels and the gyro do not go together"
        with xarray.open_dataset(path, engine="h5netcdf", group="camera") as camera:
            if camera.temperature.dims != ("time", "row", "column") or camera.temperature.isel(time=0).shape != (24, 32):
                yield "frames are not (time, row, column)"
            if camera.sizes["time"] != samples.sizes["time"]:
                yield "there is not one sample a frame"


if __name__ == "__main__":
    warnings.simplefilter("error")
    problems = [problem for group, expected in GROUPS.items() for problem in check_group(sys.argv[1], group, expected)]
    problems += check_use(sys.argv[1])
    print("\n".join(problems))
    sys.exit(1 if problems else 0)
