# SPDX-License-Identifier: MIT
"""Changes one thing of a session by the rules of HDF5, with the stock library.

usage: falsify.py WHOLE FOLDER   (writes FOLDER/<kind>.h5 for each kind)"""
import os
import shutil
import sys
import zlib

import h5py
import numpy


def set_text(name, value):
    def change(session):
        session.attrs[name] = value
    return change


def replace(path, values, good_sum=True, **options):
    """Another dataset in the place of the one at `path`; its checksum is that of the new values, or the old one."""
    def change(session):
        old = session[path]
        new_values = numpy.asarray(values(old[...]))
        crc = old.attrs["crc32"]
        if good_sum:
            crc = crc.dtype.type(zlib.crc32(new_values.tobytes()))
        del session[path]
        new = session.create_dataset(path, data=new_values, **options)
        new.attrs["crc32"] = crc
    return change


def with_last(value):
    def values(old):
        old[-1] = value
        return old
    return values


def link(kind):
    def change(session):
        del session["gyro/rate"]
        session["gyro/rate"] = kind
    return change


def external(session):
    rows = session["gyro/rate"].shape[0]
    del session["gyro/rate"]
    file = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    file.set_external(b"/etc/passwd", 0, 4 * rows)
    h5py.h5d.create(session["gyro"].id, b"rate", h5py.h5t.NATIVE_FLOAT, h5py.h5s.create_simple((rows,)), file)


def other_text(session):
    session["events/message"][0] = "nothing happened"


def texts_of_fixed_size(session):
    rows = session["events/message"].shape[0]
    del session["events/message"]
    session.create_dataset("events/message", data=numpy.full(rows, b"text", dtype="S8"))


def settle(session):
    session["samples"].attrs["settle_s"] = session["samples"].attrs["settle_s"] + 1.0


def same(old):
    return old


def set_attribute(path, name, value):
    def change(session):
        attributes = session[path].attrs
        attributes.modify(name, numpy.asarray(value, dtype=attributes[name].dtype))
    return change


def set_text_attribute(path, name, value):
    def change(session):
        session[path].attrs[name] = value
    return change


def remove_attribute(path, name):
    return lambda session: session[path].attrs.__delitem__(name)


def other_value(path, value):
    """One value of a dataset, in place; its checksum stays what it was."""
    def change(session):
        if session[path].shape:
            session[path][0] = value
        else:
            session[path][()] = value
    return change


def with_attributes_of_others(session):
    session.attrs["operator"] = "Ada"
    session["gyro"].attrs["serial"] = numpy.arange(3)
    session["gyro/rate"].attrs["reviewed"] = True
    session.create_group("notes").attrs["text"] = "mine"


PACKED = {"compression": "gzip", "chunks": True}
KINDS = {
    "quality_speed": other_value("quality/speed", 3.5),
    "quality_frames": other_value("quality/speed_frames", 5),
    "quality_valid": other_value("quality/speed_valid", 5),
    "profile_value": set_attribute("rig/profile/gyro", "scale", 1.25),
    "profile_text": set_text_attribute("rig/profile/servo", "kind", "continuous"),
    "profile_field": remove_attribute("rig/profile/camera", "mirrored"),
    "profile_table": lambda session: session["rig/profile"].__delitem__("gyro"),
    "profile": lambda session: session["rig"].__delitem__("profile"),
    "plan_toml": other_value("rig/plan_toml", "frames_per_leg = 1\n"),
    "command_time": other_value("servo/command_time", 0.5),
    "command_text": other_value("servo/command_text", "nothing was sent"),
    "older_version": set_text("format_version", "1.3.0"),
    "newer_minor": set_text("format_version", "2.9.0"),
    "no_sums": lambda session: session["quality"].__delitem__("attribute_crc32"),
    "fewer_sums": other_value("quality/attribute_crc32", ""),
    "altered_number": set_attribute("/", "simulated", 0),
    "altered_count": set_attribute("environment", "acquisition_number", 7),
    "altered_text": set_text_attribute("quality", "verdict", "superb"),
    "altered_array": set_text_attribute("camera", "axes", ["row", "time", "column"]),
    "altered_units": set_text_attribute("gyro/rate", "units", "rad/s"),
    "altered_type": set_text_attribute("quality", "frames", "many"),
    "removed": remove_attribute("servo/state", "flag_meanings"),
    "added": with_attributes_of_others,
    "another_format": set_text("format", "another"),
    "no_format": lambda session: session.attrs.__delitem__("format"),
    "another_version": set_text("format_version", "3.0.0"),
    "no_licence": set_text("license", "free\nnow"),
    "another_state": set_text("state", "asleep"),
    "attribute": settle,
    "value": replace("gyro/rate", with_last(1.0), good_sum=False, **PACKED),
    "text": other_text,
    "fixed_text": texts_of_fixed_size,
    "type": replace("gyro/rate", lambda old: old.astype(numpy.float64), **PACKED),
    "rows": replace("gyro/rate", lambda old: old[:-1], **PACKED),
    "axis": replace("gyro/time", lambda old: old.reshape(-1, 1), **PACKED),
    "layout": replace("gyro/rate", same),
    "filter": replace("gyro/rate", same, compression="lzf", chunks=True),
    "chunks": replace("gyro/rate", same, compression="gzip", chunks=(8_000_000,), maxshape=(None,)),
    "chunk_ends": replace("raw/camera/chunk_end", with_last(1), **PACKED),
    "frame_number": replace("samples/frame", with_last(4_000_000), **PACKED),
    "soft_link": link(h5py.SoftLink("/gyro/time")),
    "external_link": link(h5py.ExternalLink("/etc/passwd", "/gyro/rate")),
    "external": external,
}

whole, folder = sys.argv[1:]
for kind, falsify in KINDS.items():
    path = os.path.join(folder, kind + ".h5")
    shutil.copyfile(whole, path)
    with h5py.File(path, "r+") as file:
        falsify(file)
