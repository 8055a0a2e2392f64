# SPDX-License-Identifier: MIT
"""Puts what the three estimators of the paper say into the columns that they had before format 2.

usage: estimates_as_format_1.py FILE"""
import sys
import zlib

import h5py

NEW = ("rate", "rate_sigma", "angle", "angle_sigma", "state", "reason", "value", "value_name", "estimator")

with h5py.File(sys.argv[1], "r+") as session:
    rows = session["estimates"]
    rate, gain = rows["rate"][:], rows["value"][:, 0]
    for name in NEW:
        del rows[name]
    columns = {"rate_gyro": rate[:, 0], "rate_thermal": rate[:, 1], "rate_fusion": rate[:, 2], "gain": gain}
    for name, values in columns.items():
        column = rows.create_dataset(name, data=values, chunks=values.shape, shuffle=True, compression="gzip",
                                     compression_opts=4, fletcher32=True)
        column.attrs["crc32"] = rows["leg"].attrs["crc32"].dtype.type(zlib.crc32(values.tobytes()))
