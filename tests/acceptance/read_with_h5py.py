# SPDX-License-Identifier: MIT
"""Holds a recorded session against the tables of docs/recording_format.md, and of profile.md beside it, with stock h5py,
no code of this project.

usage: read_with_h5py.py FORMAT_PAGE FILE    exit code 0: as documented; else a sentence for each deviation"""
import pathlib
import re
import sys

import h5py

# A section's tables of datasets hold for these groups; a table of attributes begins with another heading.
GROUPS = {"/camera": ["camera"], "/gyro": ["gyro"], "/servo": ["servo"], "/sync": ["sync"],
          "/sync/camera, /sync/gyro, /sync/servo": ["sync/camera", "sync/gyro", "sync/servo"], "/sync/servo": ["sync/servo"], "/samples": ["samples"],
          "/events": ["events"], "/quality": ["quality"], "/raw": ["raw/camera", "raw/gyro", "raw/servo", "raw/sent"]}
KINDS = {"f32": "<f4", "f64": "<f8", "u8": "|u1", "u16": "<u2", "u32": "<u4", "u64": "<u8", "i16": "<i2", "i32": "<i4", "i64": "<i8"}
FIXED = {"24": 24, "32": 32, "3": 3}


def rows(page):
    """(section, names, type, units) of every row of a table whose second column is a type."""
    section, is_datasets = "", False
    for line in page.splitlines():
        if line.startswith("## "):
            section = line[3:].strip()
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")] if line.startswith("|") else []
        if not cells:
            is_datasets = False
        elif cells[0] == "dataset":
            is_datasets = True
        elif is_datasets and not cells[0].startswith("---"):
            yield section, re.findall(r"`(\w+)`", cells[0]), cells[1], cells[2]


def deviations_of_type(dataset, text, letters):
    kind, *shape = re.findall(r"\w+", text)
    if kind in KINDS and dataset.dtype.str != KINDS[kind]:
        yield f"{dataset.name} is of type {dataset.dtype.str}, documented is {kind}"
    if shape and len(shape) != dataset.ndim:
        yield f"{dataset.name} has {dataset.ndim} axes, documented are {len(shape)}"
    for axis, letter in enumerate(shape[:dataset.ndim]):
        length = FIXED.get(letter) or letters.setdefault(letter, dataset.shape[axis])
        if length != dataset.shape[axis]:
            yield f"{dataset.name} has {dataset.shape[axis]} values along {letter}, others have {length}"


def deviations_of_row(file, group, names, kind, units, letters):
    for name in names:
        if group == "raw/sent" and name == "arrival_ns" or group != "raw/sent" and name == "sent_ns" and group.startswith("raw"):
            continue
        if name not in file[group]:
            yield f"{group}/{name} is documented and missing"
            continue
        dataset = file[group][name]
        if "," not in units and units and dataset.attrs.get("units") != units:
            yield f"{dataset.name} has the unit {dataset.attrs.get('units')!r}, documented is {units!r}"
        one_kind = re.fullmatch(r"\w+( \([\w,]+\))?", kind)
        if one_kind:
            yield from deviations_of_type(dataset, kind, letters)


def profile_rows(page):
    """(group, key) of every row of the tables of docs/profile.md."""
    group = "rig/profile"
    for line in page.splitlines():
        if line.startswith("## `["):
            group = "rig/profile/" + line[5:-2].replace(".", "/")
        key = re.match(r"\| `(\w+)` \|", line)
        if key:
            yield group, key.group(1)


def deviations_of_profile(page, file):
    """Each key of the profile is an attribute of its table's group; a table of settings may be missing."""
    documented = {}
    for group, key in profile_rows(page):
        documented.setdefault(group, set()).add(key)
    for group, keys in documented.items():
        if group in file and set(file[group].attrs) != keys:
            yield f"{group} has the attributes {sorted(file[group].attrs)}, documented are {sorted(keys)}"
    if not {"rig/profile", "rig/profile/camera", "rig/profile/gyro/text", "rig/profile/servo"} <= documented.keys():
        yield "the tables of the profile's page cannot be read any more"


def has_named_axes(dataset):
    if dataset.attrs.get("CLASS") == b"DIMENSION_SCALE":
        return True
    return all(len(dim) == 1 and dim[0].name for dim in dataset.dims)


def check(page, profile_page, path):
    documented, letters, letters_of_group = {}, {}, {}
    with h5py.File(path, "r") as file:
        for section, names, kind, units in rows(page):
            for group in GROUPS.get(section, []):
                documented.setdefault(group, set()).update(names)
                # A table that holds for several groups says nothing of their lengths against each other.
                own = letters if section == "/raw" or "," not in section else letters_of_group.setdefault(group, {})
                yield from deviations_of_row(file, group, names, kind, units, own)
        for group in sorted({group for groups in GROUPS.values() for group in groups}):
            for name, item in file[group].items():
                if not isinstance(item, h5py.Dataset):
                    continue
                if name not in documented.get(group, ()):
                    yield f"{group}/{name} is not documented"
                if not item.attrs.get("units") or not item.attrs.get("long_name"):
                    yield f"{item.name} has no unit or no name"
                if not has_named_axes(item):
                    yield f"{item.name} has an axis without a name"
                item[()]
        yield from deviations_of_profile(profile_page, file)
    if len(documented) != len({group for groups in GROUPS.values() for group in groups}) or letters.get("N", 0) == 0:
        yield "the tables of the format page cannot be read any more"


if __name__ == "__main__":
    format_page = pathlib.Path(sys.argv[1])
    problems = list(check(format_page.read_text(encoding="utf-8"),
                          format_page.with_name("profile.md").read_text(encoding="utf-8"), sys.argv[2]))
    print("\n".join(problems))
    sys.exit(1 if problems else 0)
