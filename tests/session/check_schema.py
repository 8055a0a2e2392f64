# SPDX-License-Identifier: MIT
"""Checks a session as a stranger's program sees it: stock h5py, no code of this project.

usage: check_schema.py FILE FRAMES       exit code 0: as documented; else a sentence for each deviation
       check_schema.py --digest FILE     prints a hash of the values of every dataset"""
import hashlib
import pathlib
import re
import sys
import zlib

import h5py
import numpy

FORMAT = pathlib.Path(__file__).parents[2] / "docs" / "recording_format.md"
TYPES = {"text": "object", **{f"{letter}{8 * size}": f"{kind}{8 * size}" for letter, kind in
                              (("u", "uint"), ("i", "int"), ("f", "float")) for size in (1, 2, 4, 8)}}
NETCDF_BARE = b"This is a netCDF dimension but not a netCDF variable."


def datasets(file):
    found = []
    file.visititems(lambda name, item: found.append(item) if isinstance(item, h5py.Dataset) else None)
    return found


def check_dataset(dataset):
    for name in ("units", "long_name"):
        if not isinstance(dataset.attrs.get(name), str):
            yield f"{dataset.name} has no text attribute {name}"
    is_scale = dataset.attrs.get("CLASS") == b"DIMENSION_SCALE"
    for axis in range(dataset.ndim):
        if not is_scale and len(dataset.dims[axis]) != 1:
            yield f"{dataset.name} has no scale on axis {axis}"
        if not is_scale and dataset.dims[axis][0].shape[0] != dataset.shape[axis]:
            yield f"{dataset.name} and the scale of axis {axis} differ in length"
    if dataset.ndim and dataset.shape[0] == 0 and not dataset.chunks:
        yield f"{dataset.name} has no rows and no chunks: h5repack would fail"
    is_packed = dataset.chunks and dataset.size
    if is_packed and not (dataset.compression == "gzip" and dataset.compression_opts == 4 and dataset.fletcher32):
        yield f"{dataset.name} has other filters than gzip 4 and fletcher32"
    if is_packed and dataset.shuffle != (dataset.dtype.itemsize > 1):
        yield f"{dataset.name} is shuffled where it should not be, or not where it should"
    flags = dataset.attrs.get("flag_values", dataset.attrs.get("flag_masks"))
    if flags is not None:
        if flags.dtype != dataset.dtype or len(flags) != len(dataset.attrs["flag_meanings"].split()):
            yield f"{dataset.name} has flags that do not match"
    if "crc32" in dataset.attrs and dataset.dtype != object:
        if zlib.crc32(dataset[()].tobytes()) != dataset.attrs["crc32"]:
            yield f"{dataset.name} differs from its crc32"


def check_groups(file, frames):
    shapes = {"camera/temperature": (frames, 24, 32), "samples/rate_shaft": (frames,),
              "samples/reason_bits": (frames,), "raw/camera/bytes": (1544 * frames,),
              "camera/half_begin": (frames, 2), "camera/half_end": (frames, 2), "camera/half_age": (frames, 2),
              "samples/rate_commanded": (frames,), "samples/rate_shaft_half": (frames, 2),
              "samples/rate_commanded_half": (frames, 2), "samples/rate_gyro_half": (frames, 2),
              "samples/gyro_spread": (frames,), "samples/rate_commanded_uncertainty": (frames,),
              "samples/rate_corrected": (frames,), "samples/rate_corrected_uncertainty": (frames,),
              "samples/rate_corrected_half": (frames, 2), "samples/angle_measured": (frames,),
              "samples/rate_measured": (frames,), "samples/rate_measured_half": (frames, 2),
              "samples/rate_measured_uncertainty": (frames,)}
    for name, shape in shapes.items():
        if file[name].shape != shape:
            yield f"{name} has shape {file[name].shape}, not {shape}"
    plots = {"camera": ("temperature", ["time", "row", "column"]), "gyro": ("rate", ["time"]),
             "servo": ("rate_commanded", ["time"]), "samples": ("rate_shaft", ["time"])}
    for name, (signal, axes) in plots.items():
        attributes = file[name].attrs
        if (attributes["NX_class"], attributes["signal"], list(attributes["axes"])) != ("NXdata", signal, axes):
            yield f"{name} is not marked for viewers"
    if list(file["samples"].attrs["auxiliary_signals"]) != ["rate_gyro"]:
        yield "samples does not plot the gyro beside the label"
    if file["camera/temperature"].attrs["interpretation"] != "image":
        yield "camera/temperature is not marked as images"


def check_sync(file):
    for device in ("camera", "gyro", "servo"):
        for name in ("time_earlier", "time_later"):
            if file[device][name].shape != file[device]["time"].shape:
                yield f"{device}/{name} is not as long as time"
        clock = file["sync"][device]
        for name in ("method", "rate_hz", "skew_ppm", "wander_ppm", "late_p50_us", "late_p95_us", "late_max_us",
                     "uncertainty_us", "bound_us", "bound_median_us", "bound_wander_ppm",
                     "needed_wander_ppm", "own_time_unused", "largest_constant_delay_s", "latency_s",
                     "latency_uncertainty_s"):
            if name not in clock.attrs:
                yield f"sync/{device} has no attribute {name}"
        for axis, names in {"knot_time": ("offset", "skew_ppm", "residual_us"), "epoch_begin": ("epoch_reason",),
                            "gap_begin": ("gap_end", "gap_missing")}.items():
            for name in names:
                if clock[name].shape != clock[axis].shape:
                    yield f"sync/{device}/{name} is not as long as {axis}"
    age = file["camera/time"][:][:, None] - file["camera/half_end"][:]
    if (abs(age - file["camera/half_age"][:]) > 1e-6).any():
        yield "camera/half_age is not time - half_end"


def check_estimates(file):
    if "estimates" not in file:
        return
    estimates = file["estimates"]
    for name in ("frame", "rate_commanded", "counted", "reason_bits",
                 "leg", "run", "exposure_begin", "exposure_end", "arrival_ns"):
        if estimates[name].shape != estimates["time"].shape:
            yield f"estimates/{name} is not as long as time"
    names = [name.decode() for name in estimates["estimator"][()]]
    for name in ("rate", "rate_sigma", "angle", "angle_sigma", "state", "reason"):
        if estimates[name].shape != (len(estimates["time"]), len(names)):
            yield f"estimates/{name} is not a column an estimator"
        if [len(axis) for axis in estimates[name].dims] != [1, 1] or estimates[name].dims[1][0] != estimates["estimator"]:
            yield f"estimates/{name} does not name its estimators"
    if [name.decode() for name in estimates["value_name"][()]] != ["cnn-fusion.gain"]:
        yield "estimates/value_name is not what the estimators say besides"
    attributes = estimates.attrs
    if (attributes["NX_class"], attributes["signal"], attributes["model"]) != ("NXdata", "rate", "best.onnx"):
        yield "estimates is not marked for viewers, or does not name its model"


def documented():
    """{path of a dataset: (type, units)} by the tables of docs/recording_format.md; "as in /camera" is looked up there."""
    found, groups = {}, []
    for line in FORMAT.read_text().splitlines():
        if line.startswith("## "):
            groups = re.findall(r"/[a-z_/]+", line)
        cells = [cell.strip() for cell in line.split("|")[1:-1]]
        names = re.findall(r"`([a-z_0-9]+)`", cells[0]) if len(cells) == 4 else []
        types = re.findall(r"\b(?:[uif]\d+|text)\b", cells[1]) if names else []
        alike = re.fullmatch(r"as in (/[a-z/]+)", cells[3]) if names else None
        for group in groups:
            for place, name in enumerate(names):
                if alike:
                    found[f"{group}/{name}"] = found[f"{alike[1]}/{name}"]
                else:  # an axis without values has no type
                    kind = TYPES[types[place if len(types) > 1 else 0]] if types else None
                    found[f"{group}/{name}"] = (kind, cells[2])
    return found


def check_types(file):
    meant = documented()
    groups = {path.rsplit("/", 1)[0] for path in meant}
    for dataset in datasets(file):
        if dataset.name not in meant:
            if dataset.parent.name in groups:
                yield f"{dataset.name} is not documented"
            continue
        kind, units = meant[dataset.name]
        if kind and dataset.dtype != kind:
            yield f"{dataset.name} is {dataset.dtype}, not {kind}"
        if units and dataset.attrs["units"] != units:
            yield f"{dataset.name} is in {dataset.attrs['units']}, not {units}"


def check_root(file):
    expected = {"NX_class": "NXroot", "default": "samples", "format": "thermorig-session",
                "format_version": "2.5.0", "simulated": 1, "simulation_seed": 3, "state": "complete",
                "Conventions": "CF-1.10", "start_time": "2026-07-25T14:35:59.900001Z",
                "time_reference": "2026-07-25T14:35:59.900001Z"}
    for name, value in expected.items():
        if file.attrs.get(name) != value:
            yield f"root attribute {name} is {file.attrs.get(name)!r}"
    names = []
    file.id.links.iterate(lambda name: names.append(name.decode()), idx_type=h5py.h5.INDEX_CRT_ORDER)
    live = ["estimates"] if "estimates" in file else []
    shaft = ["shaft"] if "shaft" in file else []
    if names != ["camera", "gyro", "servo", *shaft, "sync", "samples", *live, "events", "environment", "rig", "quality", "raw"]:
        yield f"groups in the order of creation: {names}"
    if file["environment"].attrs["difficulty"] != "high":
        yield "the garden is not marked as difficult"
    if file.id.get_create_plist().get_version()[0] != 0:
        yield "the superblock is not of the earliest version"


def check(path, frames):
    with h5py.File(path, "r") as file:
        yield from check_root(file)
        yield from check_groups(file, frames)
        yield from check_sync(file)
        yield from check_estimates(file)
        yield from check_types(file)
        for dataset in datasets(file):
            dataset[()]  # stock filters: inflates and holds every chunk against its fletcher32
            yield from check_dataset(dataset)


def digest(path):
    with h5py.File(path, "r") as file:
        for dataset in datasets(file):
            values = numpy.asarray(dataset[()])
            data = repr(values.tolist()).encode() if values.dtype == object else values.tobytes()
            print(dataset.name, hashlib.sha256(data).hexdigest())


if __name__ == "__main__":
    if sys.argv[1] == "--digest":
        digest(sys.argv[2])
        sys.exit()
    problems = list(check(sys.argv[1], int(sys.argv[2])))
    print("\n".join(problems))
    sys.exit(1 if problems else 0)
