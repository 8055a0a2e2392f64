# SPDX-License-Identifier: MIT
"""Puts attributes of every kind into a session, as its owner may, or looks whether they are there.

usage: added_attributes.py add|check FILE"""
import sys

import h5py
import numpy

TEXTS = {"": "Ada, früh", "array": numpy.array(["a", "", "ccc"], dtype=h5py.string_dtype()),
         "fixed": numpy.bytes_("fixed")}
NUMBERS = {"int": 7, "float": numpy.float32(0.25), "array": numpy.arange(6).reshape(2, 3), "bool": True,
           "complex": numpy.complex128(1 + 2j), "big_endian": numpy.array([1, 2], dtype=">i4"), "none": h5py.Empty("f8")}
OBJECTS = ("/", "gyro", "gyro/rate", "raw/sent", "quality")


def add(file):
    for name in OBJECTS:
        for kind, value in TEXTS.items():
            file[name].attrs["operator" + kind] = value
        for kind, value in NUMBERS.items():
            file[name].attrs["number_" + kind] = value
    file["camera"].attrs["mode"] = "full-fresh"  # not theirs: what is written anew is what counts
    file.create_dataset("notes", data=[1, 2]).attrs["operator"] = "Ada"
    file.attrs["place"] = file["gyro"].ref


def same(value, wanted):
    if isinstance(wanted, h5py.Empty):
        return isinstance(value, h5py.Empty)
    return numpy.asarray(value).dtype.kind == numpy.asarray(wanted).dtype.kind and numpy.array_equal(value, wanted)


def check(file):
    for name in OBJECTS:
        for prefix, kinds in (("operator", TEXTS), ("number_", NUMBERS)):
            for kind, wanted in kinds.items():
                if prefix + kind not in file[name].attrs:
                    yield f"{name} has lost {prefix + kind}"
                elif not same(file[name].attrs[prefix + kind], wanted):
                    yield f"{name}: {prefix + kind} is {file[name].attrs[prefix + kind]!r}"
    if file["camera"].attrs["mode"] != "half-fresh":
        yield "the camera's mode is not what was written anew"
    if "notes" in file or "place" in file.attrs:
        yield "an added dataset or a reference was kept, which is documented otherwise"


if sys.argv[1] == "add":
    with h5py.File(sys.argv[2], "r+") as session:
        add(session)
    sys.exit()
with h5py.File(sys.argv[2], "r") as session:
    problems = list(check(session))
print("\n".join(problems))
sys.exit(1 if problems else 0)
