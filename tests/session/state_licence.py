# SPDX-License-Identifier: MIT
"""States the licence of a session's data, as its owner would with the stock library, or with a tool that writes text
of another kind.

usage: state_licence.py SESSION LICENCE [variable|ascii|zeros]"""
import sys

import h5py
import numpy

path, licence, kind = (sys.argv[1:] + ["variable"])[:3]
types = {"variable": h5py.string_dtype("utf-8"), "ascii": h5py.string_dtype("ascii"),
         "zeros": h5py.string_dtype("ascii", 40)}
with h5py.File(path, "r+") as session:
    print("was:", session.attrs["license"])
    del session.attrs["license"]
    value = numpy.bytes_(licence) if kind == "zeros" else licence
    session.attrs.create("license", value, dtype=types[kind])
