# SPDX-License-Identifier: MIT
"""The benchmark's peer: a recorder as a careful Python user would write it with pyserial, numpy and h5py.

It reads the same three byte streams, decodes them with struct, binascii and numpy, labels each frame with the mean
commanded speed over its exposure, and writes one HDF5 file with the same filters, rows in blocks, one fsync at the end.

    record_peer.py replay FOLDER OUT.h5        decode and write the byte streams of FOLDER, print times as JSON
    record_peer.py ports CAMERA GYRO SERVO SECONDS OUT.h5     the same from three serial ports (nothing moves)

FOLDER holds {camera,gyro,servo}.bin (bytes) and {camera,gyro,servo}.npz (chunk_end, arrival_ns).
"""
import binascii
import json
import os
import struct
import sys
import time

import h5py
import numpy as np

FRAME = 1544
HEADER = bytes.fromhex("5a5a0206")
BYTE_TIME_NS = {"camera": 1e10 / 460800, "gyro": 1e10 / 115200, "servo": 1e10 / 250000}


class Camera:
    """GY-MCU90640 frames: header, 768 centidegrees, sensor temperature, 16-bit word sum."""

    def __init__(self):
        self.buffer = bytearray()
        self.frames, self.arrivals = [], []

    def push(self, data, arrived):
        buffer = self.buffer
        buffer += data
        while True:
            start = buffer.find(HEADER)
            if start < 0:
                del buffer[:-3]
                return
            if len(buffer) - start < FRAME:
                del buffer[:start]
                return
            words = np.frombuffer(bytes(buffer[start : start + FRAME]), "<u2")
            if int(words[:771].sum(dtype=np.uint32)) & 0xFFFF == words[771]:
                self.frames.append(words[2:771].view("<i2"))
                self.arrivals.append(arrived - (FRAME + len(buffer) - start - FRAME) * BYTE_TIME_NS["camera"])
                del buffer[: start + FRAME]
            else:
                del buffer[: start + 1]


class Gyro:
    """WitMotion packets: 0x55, type, four words, byte sum."""

    packet = struct.Struct("<hhhh")

    def __init__(self):
        self.buffer = bytearray()
        self.rates, self.arrivals = [], []

    def push(self, data, arrived):
        buffer = self.buffer
        buffer += data
        at, end = 0, len(buffer)
        while end - at >= 11:
            if buffer[at] == 0x55 and sum(buffer[at : at + 10]) & 0xFF == buffer[at + 10]:
                if buffer[at + 1] == 0x52:
                    self.rates.append(self.packet.unpack_from(buffer, at + 2))
                    self.arrivals.append(arrived - (end - at) * BYTE_TIME_NS["gyro"])
                at += 11
            else:
                at += 1
        del buffer[:at]


class Servo:
    """Telemetry of the servo link: flag, escaped body with CRC-16, flag."""

    telemetry = struct.Struct("<IiiHBBH")

    def __init__(self):
        self.buffer = b""
        self.rows, self.arrivals = [], []

    def push(self, data, arrived):
        *bodies, self.buffer = (self.buffer + data).split(b"\x7e")
        for body in bodies:
            if b"\x7d" in body:
                parts = body.split(b"\x7d")
                body = parts[0] + b"".join(bytes((p[0] ^ 0x20,)) + p[1:] for p in parts[1:] if p)
            if len(body) == 22 and body[0] == 0x84 and not binascii.crc_hqx(body[:-2], 0xFFFF) ^ (
                body[-2] | body[-1] << 8
            ):
                self.rows.append(self.telemetry.unpack_from(body, 2))
                self.arrivals.append(arrived)


def label(camera, gyro, servo):
    """Mean commanded speed and mean gyro rate over each frame's exposure, all arrays at once."""
    frame_end = np.array(camera.arrivals) * 1e-9
    period = np.median(np.diff(frame_end))
    begin, end = frame_end - 2 * period, frame_end
    rows = np.array(servo.rows, dtype=np.float64)
    servo_time = np.array(servo.arrivals) * 1e-9
    rate = rows[:, 2] * 0.01
    fine = rows[:, 4] >= 128  # pulse ticks of 1/16 us; else of 1/2 us

    def mean(times, values, low, high):
        area = np.concatenate([[0.0], np.cumsum(np.diff(times) * 0.5 * (values[1:] + values[:-1]))])
        return (np.interp(high, times, area) - np.interp(low, times, area)) / (high - low)

    rate_shaft = mean(servo_time, rate, begin, end)
    settled_low = np.searchsorted(servo_time, begin - 0.2)
    settled_high = np.searchsorted(servo_time, end)
    changes = np.concatenate([[0], np.cumsum(np.abs(np.diff(rate)) > 0.05)])
    last = len(rate) - 1
    valid = changes[np.minimum(settled_high, last)] == changes[np.minimum(settled_low, last)]
    valid &= rows[np.minimum(settled_low, last), 6] > 0
    gyro_time = np.array(gyro.arrivals) * 1e-9
    gyro_rate = np.array(gyro.rates, dtype=np.float64)[:, 2] * (2000.0 / 32768.0)
    total = np.concatenate([[0.0], np.cumsum(gyro_rate)])
    low, high = np.searchsorted(gyro_time, begin), np.searchsorted(gyro_time, end)
    count = high - low
    rate_gyro = (total[high] - total[low]) / np.maximum(count, 1)
    frames = np.stack(camera.frames)
    change = frames[1:, :768] != frames[:-1, :768]
    even = ((np.arange(24)[:, None] ^ np.arange(32)) & 1).ravel() == 0
    fresh = np.stack([change[:, even].sum(axis=1), change[:, ~even].sum(axis=1)], axis=1)
    return {
        "camera/time": frame_end,
        "camera/temperature": (frames[:, :768] * np.float32(0.01)).astype(np.float32).reshape(-1, 24, 32),
        "camera/sensor_temperature": (frames[:, 768] * 0.01).astype(np.float32),
        "camera/fresh": np.vstack([[384, 384], fresh]).astype(np.uint16),
        "gyro/time": gyro_time,
        "gyro/rate": gyro_rate.astype(np.float32),
        "gyro/counts": np.array(gyro.rates, dtype=np.int16)[:, :3],
        "servo/time": servo_time,
        "servo/device_ticks": rows[:, 0].astype(np.uint32),
        "servo/angle_commanded": (rows[:, 1] * 0.01).astype(np.float32),
        "servo/rate_commanded": rate.astype(np.float32),
        "servo/pulse_width": (rows[:, 3] / np.where(fine, 16, 2)).astype(np.float32),
        "servo/state": rows[:, 4].astype(np.uint8) & 0x7F,
        "samples/rate_shaft": rate_shaft.astype(np.float32),
        "samples/rate_gyro": rate_gyro.astype(np.float32),
        "samples/gyro_count": count.astype(np.uint16),
        "samples/valid": valid.astype(np.uint8),
    }


def decode(chunks):
    devices = {"camera": Camera(), "gyro": Gyro(), "servo": Servo()}
    for name, data, arrived in chunks:
        devices[name].push(data, arrived)
    return label(devices["camera"], devices["gyro"], devices["servo"])


def write(path, arrays):
    with h5py.File(path, "w") as file:
        for name, array in arrays.items():
            rows = 64 if array.ndim == 3 else min(len(array), 8192)
            data = file.create_dataset(name, array.shape, array.dtype, chunks=(rows,) + array.shape[1:], shuffle=True,
                                       compression="gzip", compression_opts=4, fletcher32=True)
            for first in range(0, len(array), rows):
                data[first : first + rows] = array[first : first + rows]
    handle = os.open(path, os.O_RDONLY)
    os.fsync(handle)
    os.close(handle)


def load(folder):
    chunks, raw = [], {}
    for name in ("camera", "gyro", "servo"):
        data = open(os.path.join(folder, name + ".bin"), "rb").read()
        index = np.load(os.path.join(folder, name + ".npz"))
        begin = 0
        for end, arrived in zip(index["chunk_end"].tolist(), index["arrival_ns"].tolist()):
            chunks.append((name, data[begin:end], arrived))
            begin = end
        raw[f"raw/{name}/bytes"] = np.frombuffer(data, np.uint8)
        raw[f"raw/{name}/chunk_end"] = index["chunk_end"]
        raw[f"raw/{name}/arrival_ns"] = index["arrival_ns"]
    chunks.sort(key=lambda chunk: chunk[2])
    return chunks, raw


def replay(folder, out):
    chunks, raw = load(folder)
    start = time.perf_counter()
    arrays = decode(chunks)
    decoded = time.perf_counter()
    write(out, {**arrays, **raw})
    done = time.perf_counter()
    print(json.dumps({"decode_s": decoded - start, "session_s": done - start,
                      "frames": len(arrays["camera/time"]), "gyro": len(arrays["gyro/time"]),
                      "telemetry": len(arrays["servo/time"]), "valid": int(arrays["samples/valid"].sum())}))


def ports(camera, gyro, servo, seconds, out):
    import serial

    opened = {"camera": serial.Serial(camera, 460800, timeout=0), "gyro": serial.Serial(gyro, 115200, timeout=0),
              "servo": serial.Serial(servo, 250000, timeout=0)}
    chunks, until = [], time.monotonic() + float(seconds)
    while time.monotonic() < until:
        for name, port in opened.items():
            if data := port.read(4096):
                chunks.append((name, data, time.monotonic_ns()))
        time.sleep(0.001)
    write(out, decode(chunks))


if __name__ == "__main__":
    {"replay": replay, "ports": ports}[sys.argv[1]](*sys.argv[2:])
