# SPDX-License-Identifier: MIT
"""States the licence of a session's data, as its owner would with the stock library.

usage: state_licence.py SESSION LICENCE"""
import sys

import h5py

path, licence = sys.argv[1:]
with h5py.File(path, "r+") as session:
    print("was:", session.attrs["license"])
    session.attrs["license"] = licence
