# SPDX-License-Identifier: MIT
"""The benchmark's peer: a recorder as a careful Python user would write it with pyserial, numpy and h5py.

It reads the same three byte streams, decodes them with struct, binascii and numpy, takes each device's clock for an even
one behind a constant delay, labels each frame and each of its chess halves with the mean commanded speed over its own
exposure, and writes one HDF5 file with the same filters, rows in blocks, one fsync at the end.

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
BLOCK_S = 10.0  # of a clock: so long it runs evenly
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


def constant_delay(count, arrived):
    """Times of a clock that ran evenly: the arrivals are what it said and a delay that is never less than the least of
    its block, straight in between. `count` is the device's own, in any unit."""
    slope, level = np.polyfit(count, arrived, 1)
    late = arrived - (level + slope * count)
    begins = np.searchsorted(count, np.arange(count[0], count[-1], BLOCK_S / slope))
    least = np.minimum.reduceat(late, begins)
    at = np.array([begin + late[begin:end].argmin() for begin, end in zip(begins, [*begins[1:], len(late)])])
    return level + slope * count + np.interp(count, count[at], least)


def least_of_next(values):
    """Of each value and the 63 behind it."""
    for step in (1, 2, 4, 8, 16, 32):
        values = np.minimum(values, np.concatenate([values[step:], np.full(step, values[-1])]))
    return values


def numbered(arrived):
    """Which message of an even stream each one is. Those that were lost count too: after a gap that nothing catches up
    with, all that follow are later by whole periods."""
    period = (arrived[-1] - arrived[0]) / (len(arrived) - 1)  # few are lost
    late = arrived - np.arange(len(arrived)) * period
    before, after = least_of_next(late[::-1])[::-1][:-1], least_of_next(late)[1:]
    lost = np.where(np.diff(arrived) > 1.5 * period, np.rint((after - before) / period), 0)
    return np.arange(len(arrived)) + np.concatenate([[0], np.cumsum(np.maximum(lost, 0))])


def fresh_pixels(frames):
    """How many pixels of either chess half differ from the frame before."""
    change = frames[1:, :768] != frames[:-1, :768]
    even = ((np.arange(24)[:, None] ^ np.arange(32)) & 1).ravel() == 0
    return np.vstack([[384, 384], np.stack([change[:, even].sum(axis=1), change[:, ~even].sum(axis=1)], axis=1)])


def exposures(frame_end, fresh):
    """Begin and end of what each half (n, 2) shows, and of both together: a half that is not fresh shows what it
    showed in the frame before."""
    period = np.median(np.diff(frame_end))
    is_fresh = fresh > 7
    newest = np.where(is_fresh[:, 1] & ~is_fresh[:, 0], 1, 0)
    both = is_fresh.all(axis=1)
    behind = np.stack([newest == 1, newest == 0], axis=1) * both[:, None] * period
    last = np.maximum.accumulate(np.where(is_fresh, np.arange(len(fresh))[:, None], 0), axis=0)
    half_end = frame_end[last] - np.take_along_axis(behind, last, axis=0)
    half_begin = half_end - period
    return half_begin, half_end, half_begin.min(axis=1), half_end.max(axis=1)


def label(camera, gyro, servo):
    """Mean commanded speed and mean gyro rate over each frame's exposure and over that of each of its halves, on clocks
    of constant delay; all arrays at once."""
    arrived = np.array(camera.arrivals) * 1e-9
    frame_end = constant_delay(numbered(arrived), arrived)
    frames = np.stack(camera.frames)
    fresh = fresh_pixels(frames)
    half_begin, half_end, begin, end = exposures(frame_end, fresh)
    rows = np.array(servo.rows, dtype=np.float64)
    ticks = np.unwrap(rows[:, 0], period=2.0**32)
    servo_time = constant_delay(ticks, np.array(servo.arrivals) * 1e-9)
    rate = rows[:, 2] * 0.01
    fine = rows[:, 4] >= 128  # pulse ticks of 1/16 us; else of 1/2 us
    area = np.concatenate([[0.0], np.cumsum(np.diff(servo_time) * 0.5 * (rate[1:] + rate[:-1]))])

    def mean_commanded(low, high):
        return (np.interp(high, servo_time, area) - np.interp(low, servo_time, area)) / (high - low)

    settled_low = np.searchsorted(servo_time, begin - 0.2)
    settled_high = np.searchsorted(servo_time, end)
    changes = np.concatenate([[0], np.cumsum(np.abs(np.diff(rate)) > 0.05)])
    last = len(rate) - 1
    valid = changes[np.minimum(settled_high, last)] == changes[np.minimum(settled_low, last)]
    valid &= rows[np.minimum(settled_low, last), 6] > 0
    arrived = np.array(gyro.arrivals) * 1e-9
    gyro_time = constant_delay(numbered(arrived), arrived)
    gyro_rate = np.array(gyro.rates, dtype=np.float64)[:, 2] * (2000.0 / 32768.0)
    total = np.concatenate([[0.0], np.cumsum(gyro_rate)])

    def mean_gyro(low, high):
        first, behind = np.searchsorted(gyro_time, low), np.searchsorted(gyro_time, high)
        return (total[behind] - total[first]) / np.maximum(behind - first, 1), behind - first

    rate_gyro, count = mean_gyro(begin, end)
    return {
        "camera/time": frame_end,
        "camera/temperature": (frames[:, :768] * np.float32(0.01)).astype(np.float32).reshape(-1, 24, 32),
        "camera/sensor_temperature": (frames[:, 768] * 0.01).astype(np.float32),
        "camera/fresh": fresh.astype(np.uint16),
        "camera/half_begin": half_begin,
        "camera/half_end": half_end,
        "gyro/time": gyro_time,
        "gyro/rate": gyro_rate.astype(np.float32),
        "gyro/counts": np.array(gyro.rates, dtype=np.int16)[:, :3],
        "servo/time": servo_time,
        "servo/device_ticks": rows[:, 0].astype(np.uint32),
        "servo/angle_commanded": (rows[:, 1] * 0.01).astype(np.float32),
        "servo/rate_commanded": rate.astype(np.float32),
        "servo/pulse_width": (rows[:, 3] / np.where(fine, 16, 2)).astype(np.float32),
        "servo/state": rows[:, 4].astype(np.uint8) & 0x7F,
        "samples/rate_commanded": mean_commanded(begin, end).astype(np.float32),
        "samples/rate_commanded_half": mean_commanded(half_begin, half_end).astype(np.float32),
        "samples/rate_gyro": rate_gyro.astype(np.float32),
        "samples/rate_gyro_half": mean_gyro(half_begin, half_end)[0].astype(np.float32),
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
    start, start_cpu = time.perf_counter(), time.process_time()
    arrays = decode(chunks)
    decoded, decoded_cpu = time.perf_counter(), time.process_time()
    write(out, {**arrays, **raw})
    done, done_cpu = time.perf_counter(), time.process_time()
    print(json.dumps({"decode_s": decoded - start, "session_s": done - start,
                      "decode_cpu_s": decoded_cpu - start_cpu, "session_cpu_s": done_cpu - start_cpu,
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
