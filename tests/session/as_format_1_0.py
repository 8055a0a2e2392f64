# SPDX-License-Identifier: MIT
"""Takes from a session what format 1.0.0 did not have.

usage: as_format_1_0.py FILE"""
import json
import sys
import zlib

import h5py

DATASETS = [f"{device}/{name}" for device in ("camera", "gyro", "servo") for name in ("time_earlier", "time_later")]
DATASETS += ["camera/half", "camera/half_begin", "camera/half_end", "camera/half_age"]
DATASETS += [f"samples/{name}" for name in ("half", "rate_commanded", "rate_label_half", "rate_commanded_half",
                                            "rate_gyro_half", "gyro_spread")]
DATASETS += [f"sync/servo/{name}" for name in ("knot_time", "offset", "skew_ppm", "residual_us", "epoch_begin",
                                               "epoch_reason", "gap_begin", "gap_end", "gap_missing")]
DATASETS += ["sync/camera", "sync/gyro", "quality/attribute_crc32"]
DATASETS += [f"sync/{name}" for name in ("knot", "gain", "speed", "speed_residual", "speed_spread", "speed_frames")]
LINK_KEYS = ("latency_uncertainty_s", "latency_measured_utc", "largest_constant_delay_s", "wander_ppm")
KEYS = {"camera": ("orientation_measured_utc",),
        "gyro": ("scale", "scale_uncertainty", "scale_measured_utc", "bias_dps", "bias_uncertainty_dps",
                 "bias_measured_utc"),
        "servo": ("loop_hz", "scale", "scale_uncertainty", "scale_measured_utc")}
COUNTERS = ("bytes_received", "bytes_in_messages", "bytes_in_damaged", "bytes_skipped", "bytes_pending", "messages",
            "replies", "bad_checksum", "bad_length", "bad_value", "lost", "resyncs")


def old_header(text):
    header = json.loads(text)
    for device, keys in KEYS.items():
        for key in keys:
            del header["profile"][device][key]
        for key in LINK_KEYS:
            del header["profile"][device]["link"][key]
    return json.dumps(header, sort_keys=True, separators=(",", ":"), ensure_ascii=False)


def scalars(file, header):
    values = [file.attrs["state"], "true" if file.attrs["closed_by_recorder"] else "false", file.attrs["end_time_ns"],
              file["samples"].attrs["settle_s"], file["camera"].attrs["mode"], file["camera"].attrs["frame_period_s"]]
    values += [file["raw"][device].attrs[name] for device in ("camera", "gyro", "servo") for name in COUNTERS]
    return " ".join(str(value) for value in values) + header


with h5py.File(sys.argv[1], "r+") as session:
    for name in DATASETS:
        del session[name]
    for group in (session["sync"], session["sync/servo"]):
        for name in list(group.attrs):
            if name not in ("method", "host_clock", "realtime_offset_ns") or group.name != "/sync":
                del group.attrs[name]
    old = old_header(session["rig"].attrs["header_json"])
    session["rig"].attrs["header_json"] = old
    session.attrs["format_version"] = "1.0.0"
    session.attrs["scalars_crc32"] = session.attrs["scalars_crc32"].dtype.type(zlib.crc32(scalars(session, old).encode()))
