# SPDX-License-Identifier: MIT
"""Compares two recordings of one simulated rig: every dataset, raw chunks among them, and every attribute.

usage: compare_sessions.py FILE FILE    prints what differs, a name a line; exit code 1 if anything does"""
import hashlib
import json
import sys

import h5py
import numpy

# Uuid, times, host and build: what may differ between two recordings of the same bytes.
ITS_OWN = {"uuid", "start_time", "end_time", "time_reference", "start_time_utc", "realtime_offset_ns", "host_name", "kernel",
           "creator", "creator_git", "HDF5_Version", "scalars_crc32"}  # the last is a checksum of the others
CHECKSUMS = "quality/attribute_crc32"  # of all attributes, these among them


def header_without_its_own(text):
    def stripped(value):
        if isinstance(value, dict):
            return {key: stripped(item) for key, item in value.items() if key not in ITS_OWN}
        return value

    return json.dumps(stripped(json.loads(text)), sort_keys=True)


def digest(value):
    values = numpy.asarray(value)
    data = repr(values.tolist()).encode() if values.dtype == object else values.tobytes()
    return hashlib.sha256(str(values.shape).encode() + str(values.dtype).encode() + data).hexdigest()


def attribute_digests(name, item):
    for key, value in item.attrs.items():
        if key in ITS_OWN or key in ("DIMENSION_LIST", "REFERENCE_LIST"):  # addresses in the file
            continue
        yield f"{name}@{key}", digest(header_without_its_own(value) if key == "header_json" else value)


def digests(path):
    found = {}
    with h5py.File(path, "r") as file:
        found.update(attribute_digests("", file))

        def visit(name, item):
            if name == CHECKSUMS:
                return
            found.update(attribute_digests(name, item))
            if isinstance(item, h5py.Dataset):
                found[name] = digest(item[()])

        file.visititems(visit)
    return found


if __name__ == "__main__":
    first, second = digests(sys.argv[1]), digests(sys.argv[2])
    different = [name for name in sorted(first.keys() | second.keys()) if first.get(name) != second.get(name)]
    print("\n".join(different))
    sys.exit(1 if different else 0)
