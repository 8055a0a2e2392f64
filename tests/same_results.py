# SPDX-License-Identifier: MIT
"""Do the same raw bytes still give the same results? For a change of the design, which must not change any.

    /usr/bin/python3 tests/same_results.py FOLDER --remember --program OLD    once, with the program before the change
    /usr/bin/python3 tests/same_results.py FOLDER [--program build/bin/thermorig] [--relative 1e-9]

FOLDER holds sessions (.h5), made by the program before the change; --remember adds to it what that program trains on
them (model.onnx) and how it judges (evaluation.json). The comparison makes each session again from its raw bytes, in a
copy, and compares every dataset and every attribute of a group with the file before, bit for bit; then a small training
with the same seed, and all numbers of `evaluate` and `evaluate --live`. What has another name or place since stands in
RENAMED.
--relative allows floating-point numbers to differ by that share of the larger one. Exit code 1 on any difference.
"""
import argparse
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy
import onnx

# What a dataset or an attribute ("/sync@method") is called now, by its name before: a name, or a function of the open
# file that gives its values, e.g. lambda file: file["/estimates/rate"][:, 0].
def profile(table, key, convert=None):
    """What stood with a device's group until format 2 and is an attribute of the profile since."""
    def values(file):
        value = file["/rig/profile" + table].attrs[key]
        return convert(value) if convert else value
    return values


def estimate(name):
    """A column that an estimator had until format 2; NaN where the run had no such estimator."""
    def values(file):
        group = file["/estimates"]
        names = [one.decode() for one in group["estimator"][()]]
        rates = group["rate"][()]
        return rates[:, names.index(name)] if name in names else numpy.full(len(rates), numpy.nan, rates.dtype)
    return values


def gain(file):
    group = file["/estimates"]
    names = [one.decode() for one in group["value_name"][()]] if "value_name" in group else []
    found = group["value"][:, names.index("cnn-fusion.gain")] if "cnn-fusion.gain" in names else None
    return found if found is not None else numpy.full(len(group["time"]), numpy.nan, "f4")


LINK = {"port": "port", "usb_path": "usb_path", "baud": "baud", "latency_s": "latency_s", "model": "model",
        "latency_uncertainty_s": "latency_uncertainty_s", "latency_measured": "latency_measured_utc"}
FIELDS = {
    "/camera": LINK | {"checksum_policy": "checksum", "field_of_view_deg": "field_of_view_deg", "mirrored": "mirrored",
                       "orientation_measured": "orientation_measured_utc", "output_rate_setting_hz": "output_rate_hz"},
    "/gyro": LINK | {"protocol": "protocol", "rate_setting_hz": "output_rate_hz", "sign": "sign", "scale": "scale",
                     "scale_uncertainty": "scale_uncertainty", "scale_measured": "scale_measured_utc",
                     "bias_dps": "bias_dps", "bias_uncertainty_dps": "bias_uncertainty_dps",
                     "bias_measured": "bias_measured_utc"},
    "/servo": LINK | {key: key for key in ("kind", "travel_deg", "full_rate_dps", "pulse_min_us", "pulse_max_us",
                                           "max_rate_dps", "acceleration_dps2", "stop_margin_deg", "loop_hz", "scale",
                                           "scale_uncertainty")} | {"scale_measured": "scale_measured_utc"},
}
RENAMED = {f"{group}@{old}": profile(group, new) for group, keys in FIELDS.items() for old, new in keys.items()}
RENAMED |= {
    "/gyro@axis_used": profile("/gyro", "axis", lambda axis: numpy.int32("xyz".index(axis))),
    "/gyro@sign": profile("/gyro", "sign", numpy.int32),
    **{f"/{device}@baud": profile(f"/{device}", "baud", numpy.uint32) for device in ("camera", "gyro", "servo")},
    "/rig@name": profile("", "name"),
    "/servo@firmware": "/rig@firmware",
    "/estimates/rate_gyro": estimate("gyro"),
    "/estimates/rate_thermal": estimate("cnn-thermal"),
    "/estimates/rate_fusion": estimate("cnn-fusion"),
    "/estimates/gain": gain,
    **{f"/samples/rate_label{end}": f"/samples/rate_shaft{end}" for end in ("", "_min", "_max", "_half")},
    "/samples/angle_label": "/samples/angle_commanded",
    "/samples/label_uncertainty": "/samples/rate_shaft_uncertainty",
    "/quality@label_uncertainty_dps": "/quality@rate_shaft_uncertainty_dps",
    "/quality@label_residual_dps": "/quality@gyro_residual_dps",
    "/sync@label_residual_dps": "/sync@gyro_residual_dps",
}
# Places in the JSON that `evaluate` prints, now by before: patterns that are replaced.
RENAMED_PLACES = [(r"scores/apart$", "scores/excluded"), (r"scores/gyro/", "scores/estimators/gyro/"),
                  (r"scores/(thermal|fusion)/", r"scores/estimators/cnn-\1/"),
                  (r"(errors|mse|estimators)/(thermal|fusion)(?![\w-])", r"\1/cnn-\2")]
# The labels that a live run's estimates are held against when it is over are the finished ones, and the estimates
# those that were shown: until format 2 the gyro's was the finished session's as well. The gyro less the bias that the
# whole session knew is no estimator of the table: `gyro-rest` and `gyro-kalman`, which know less of it, stand there.
JUDGED_OTHERWISE = r"finalised/scores/gyro/|gyro_unbiased|/warnings/|\d/version$"
# What tells of the program or the form of the file, not of the recording's results.
DESCRIPTIONS = {
    "/@Conventions", "/@HDF5_Version", "/@creator", "/@creator_git", "/@default", "/@format", "/@format_version",
    "/@host_name", "/@kernel", "/@scalars_crc32", "/quality/attribute_crc32", "/rig/profile_toml", "/rig@header_json",
    "/samples@label_rule", "/samples@label_version",
}
FORM_OF_GROUPS = {"NX_class", "signal", "axes", "auxiliary_signals", "description"}
TRAINING = ["--nr", "3", "--epochs", "2", "--seed", "1", "--accept-bad"]


def things(file):
    """name -> values of every dataset that has any, and of every group's attributes."""
    found = {}

    def add(name, item):
        path = "/" + name
        if isinstance(item, h5py.Dataset):
            if "NAME" not in item.attrs or "crc32" in item.attrs:  # else an axis without values
                found[path] = item[()]
            return
        for key, value in item.attrs.items():
            if key not in FORM_OF_GROUPS:
                found[f"{path}@{key}"] = value

    add("", file)
    file.visititems(add)
    return {name: values for name, values in found.items() if name not in DESCRIPTIONS}


def now_of(file, name):
    """The values that are called `name` before; KeyError where there are none."""
    place = RENAMED.get(name, name)
    if callable(place):
        return place(file)
    path, _, key = place.partition("@")
    return file[path].attrs[key] if key else file[path][()]


def difference(before, now, relative):
    """None, or in what they differ."""
    before, now = numpy.asarray(before), numpy.asarray(now)
    if before.shape != now.shape or before.dtype != now.dtype:
        return f"{before.dtype} {before.shape} was, {now.dtype} {now.shape} is"
    if before.dtype.kind == "O":
        return None if (before == now).all() else f"{before} was, {now} is"
    if before.tobytes() == now.tobytes():
        return None
    if before.dtype.kind != "f":
        return f"{numpy.count_nonzero(before != now)} of {before.size} values"
    limit = relative * numpy.maximum(numpy.abs(before), numpy.abs(now))
    with numpy.errstate(invalid="ignore"):
        apart = ~((numpy.abs(before - now) <= limit) | (before == now) | (numpy.isnan(before) & numpy.isnan(now)))
    if relative == 0.0 or apart.any():
        most = numpy.nanmax(numpy.abs(before - now)) if apart.any() else 0.0
        return f"{max(1, numpy.count_nonzero(apart))} of {before.size} values, by at most {most:g}"
    return None


def compare_sessions(before_path, now_path, relative):
    """(number of things compared, what differs)."""
    differences = []
    with h5py.File(before_path) as before, h5py.File(now_path) as now:
        all_before = things(before)
        for name, values in all_before.items():
            try:
                differs = difference(values, now_of(now, name), relative)
            except KeyError:
                differs = "is not there any more"
            if differs:
                differences.append(f"{name}: {differs}")
    return len(all_before), differences


def run(program, *words):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join([str(program), *map(str, words)])}\n{done.stdout}{done.stderr}")
    return done.stdout


def trained(program, sessions, model):
    """Trains on every other session."""
    run(program, "train", *sessions[::2], "-o", model, *TRAINING)


def judged(program, sessions, model):
    """What `evaluate` says of the sessions that were not trained on, and of those that a live run made."""
    live = []
    for session in sessions:
        with h5py.File(session) as file:
            live += [session] if "estimates" in file else []
    texts = run(program, "evaluate", model, *sessions[1::2], "--json", "--accept-bad")
    texts += run(program, "evaluate", "--live", *live, "--json") if live else ""
    return [{key: value for key, value in json.loads(line).items() if key != "session"} for line in texts.splitlines()]


def numbers(value, path=""):
    """path -> number or text of everything in a JSON value."""
    if isinstance(value, dict):
        children = value.items()
    elif isinstance(value, list):
        children = enumerate(value)
    else:
        return {path: value}
    return {name: number for key, child in children for name, number in numbers(child, f"{path}/{key}").items()}


def compare_numbers(before, now, relative):
    before, now = numbers(before), numbers(now)
    differences = []
    for name, value in before.items():
        if re.search(JUDGED_OTHERWISE, name):
            continue
        path = name
        for before_pattern, now_pattern in RENAMED_PLACES:
            path = re.sub(before_pattern, now_pattern, path)
        if path not in now and value is None:  # no such estimator ran, and nothing is said of it any more
            continue
        if path not in now:
            differences.append(f"{path}: is not there any more")
            continue
        number = now[path]
        close = isinstance(value, float) and isinstance(number, (int, float)) and relative > 0.0 and \
            math.isclose(value, number, rel_tol=relative)
        if number != value and not close:
            differences.append(f"{path}: {value} was, {number} is")
    return len(before), differences


def without_texts(path):
    """The model's bytes but for what it says of itself and of the files that it was trained on."""
    model = onnx.load(path)
    kept = [entry for entry in model.metadata_props
            if not entry.key.startswith(("format", "training_data", "held_out_data"))]
    del model.metadata_props[:]
    model.metadata_props.extend(kept)
    model.doc_string = model.graph.doc_string = model.producer_version = ""
    for value in [*model.graph.input, *model.graph.output]:
        value.doc_string = ""
    return model.SerializeToString(deterministic=True)


def compare_models(before, now):
    if before.read_bytes() == now.read_bytes():
        return "equal", []
    if without_texts(before) == without_texts(now):
        return "equal but for its texts", []
    weights = {tensor.name: tensor.raw_data for tensor in onnx.load(now).graph.initializer}
    other = [tensor.name for tensor in onnx.load(before).graph.initializer
             if weights.get(tensor.name) != tensor.raw_data]
    return "differs", [f"model: other weights in {', '.join(other) or 'none, but the graph is another'}"]


def compare(folder, program, relative):
    """(rows of the table, all differences)."""
    rows, differences = [], []
    with tempfile.TemporaryDirectory() as scratch:
        again = [pathlib.Path(shutil.copy(session, scratch)) for session in sorted(folder.glob("*.h5"))]
        run(program, "reprocess", *again)
        for session in again:
            compared, found = compare_sessions(folder / session.name, session, relative)
            rows.append((session.stem, f"{compared} compared", found))
        model = pathlib.Path(scratch, "model.onnx")
        trained(program, again, model)
        state, found = compare_models(folder / "model.onnx", model)
        rows.append(("training", state, found))
        before = json.loads((folder / "evaluation.json").read_text(encoding="utf-8"))
        # With the model before: else its differences would be told again.
        compared, found = compare_numbers(before, judged(program, again, folder / "model.onnx"), relative)
        rows.append(("evaluation", f"{compared} compared", found))
    for name, _, found in rows:
        differences += [f"{name}: {one}" for one in found]
    return rows, differences


def remember(folder, program):
    sessions = sorted(folder.glob("*.h5"))
    with tempfile.TemporaryDirectory() as scratch:
        trained(program, sessions, pathlib.Path(scratch, "model.onnx"))
        shutil.copy(pathlib.Path(scratch, "model.onnx"), folder)
    results = judged(program, sessions, folder / "model.onnx")
    (folder / "evaluation.json").write_text(json.dumps(results), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--program", type=pathlib.Path, default=pathlib.Path("build/bin/thermorig"))
    parser.add_argument("--remember", action="store_true")
    parser.add_argument("--relative", type=float, default=0.0)
    options = parser.parse_args()
    program = options.program.resolve()
    if not list(options.folder.glob("*.h5")):
        sys.exit(f"there are no sessions in {options.folder}")
    if options.remember:
        remember(options.folder, program)
        return 0
    if not (options.folder / "evaluation.json").exists():
        sys.exit(f"{options.folder} lacks what the program before made: --remember --program OLD")
    rows, differences = compare(options.folder, program, options.relative)
    for name, compared, found in rows:
        print(f"{name:28} {compared:24} {f'{len(found)} DIFFER' if found else 'equal'}")
    for one in differences:
        print(one)
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
