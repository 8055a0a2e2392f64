# SPDX-License-Identifier: MIT
"""Runs both recorders of record_peers.sh in turns and prints medians, in Markdown: both beside each other, and what each
share of a finished session takes and buys.

    record_peers.py RECORD_BENCH SESSION.h5 FOLDER [--json]
"""
import json
import os
import pathlib
import statistics
import struct
import subprocess
import sys

import h5py
import numpy as np

ROUNDS = 5


def export_raw(session, folder):
    """The session's raw bytes as the files that record_peer.py replays."""
    with h5py.File(session) as file:
        for name in ("camera", "gyro", "servo"):
            raw = file["raw"][name]
            raw["bytes"][:].tofile(folder / (name + ".bin"))
            np.savez(folder / (name + ".npz"), chunk_end=raw["chunk_end"][:], arrival_ns=raw["arrival_ns"][:])


def chunk_bytes(session):
    """Every chunk of every compressed dataset, shuffled as the file's filter does it, filled up where the last one is
    short: what has to be compressed."""
    chunks = []

    def collect(_, item):
        if isinstance(item, h5py.Dataset) and item.compression == "gzip":
            rows = item.chunks[0]
            values = item[:]
            for first in range(0, len(values), rows):
                block = np.zeros(item.chunks, item.dtype)
                block[: len(values[first : first + rows])] = values[first : first + rows]
                flat = block.view(np.uint8).reshape(-1, block.dtype.itemsize)
                chunks.append(np.ascontiguousarray(flat.T).tobytes())

    with h5py.File(session) as file:
        file.visititems(collect)
    return chunks


def export_chunks(chunks, path):
    with open(path, "wb") as file:
        for chunk in chunks:
            file.write(struct.pack("<Q", len(chunk)) + chunk)


BENCHES = {"BytesToLabelledSamples": "samples", "BytesToMessages": "messages", "BytesToFinishedSession": "session",
           "FitsOfSession": "fits", "ServoOfSession": "servo", "TurnsOfSession": "turns", "CameraOffsetOfSession": "offset",
           "SessionToFile": "file", "SessionToFileUnread": "file_unread", "CompressingAlone": "compress"}


def ours_s(bench, session, chunks):
    """By name: seconds, and seconds of processor."""
    out = subprocess.run([bench, "--benchmark_format=json", "--benchmark_min_time=0.2"], check=True, capture_output=True,
                         env={**os.environ, "THERMORIG_BENCH_SESSION": str(session),
                              "THERMORIG_BENCH_CHUNKS": str(chunks)}).stdout
    times = {}
    for run in json.loads(out)["benchmarks"]:
        name = BENCHES[run["name"].split("/")[0]]
        times[name], times[name + "_cpu"] = run["real_time"] * 1e-3, run["cpu_time"] * 1e-3
    return with_same_work(times)


def with_same_work(times):
    """The peer labels once, on causal clocks, and writes a file that it does not read back."""
    for unit in ("", "_cpu"):
        times["same_work" + unit] = times["samples" + unit] + times["file_unread" + unit]
    return times


def peer_s(folder):
    out = subprocess.run(["/usr/bin/python3", pathlib.Path(__file__).with_name("record_peer.py"), "replay", folder,
                          folder / "peer.h5"], check=True, capture_output=True).stdout
    return json.loads(out)


def check_same_work(session, peer):
    """A peer that decoded less would be no peer."""
    with h5py.File(session) as file:
        for name, rows in (("camera", "frames"), ("gyro", "gyro"), ("servo", "telemetry")):
            if len(file[name]["time"]) != peer[rows]:
                sys.exit(f"the peer decoded {peer[rows]} of {name}, the session holds {len(file[name]['time'])}")


def main(bench, session, folder, *options):
    folder = pathlib.Path(folder)
    export_raw(session, folder)
    chunks = chunk_bytes(session)
    export_chunks(chunks, folder / "chunks.bin")
    rows = []
    for _ in range(ROUNDS):
        ours = ours_s(bench, session, folder / "chunks.bin")
        peer = peer_s(folder)
        check_same_work(session, peer)
        rows.append({**ours, "peer_samples": peer["decode_s"], "peer_session": peer["session_s"],
                     "peer_samples_cpu": peer["decode_cpu_s"], "peer_session_cpu": peer["session_cpu_s"]})
    figures = medians(rows)
    if "--json" in options:
        print(json.dumps({key: round(value, 4) for key, value in figures.items()}))
    else:
        array_bytes = sum(map(len, chunks))
        print_tables(figures, array_bytes / 1e6, os.path.getsize(session) / array_bytes)


RATIOS = {"samples": ("peer_samples", "samples"), "session": ("peer_session", "session"),
          "same_work": ("peer_session", "same_work")}
OVER_COMPRESS = ("file", "file_unread", "session")


def medians(rows):
    def median(value):
        return statistics.median(value(row) for row in rows)

    figures = {key + "_s": median(lambda row, key=key: row[key]) for key in rows[0]}
    # Of each round, then their median: what slows the computer slows both.
    for name, (over, under) in RATIOS.items():
        for unit in ("", "_cpu"):
            figures[f"{name}{unit}_ratio"] = median(lambda row, o=over + unit, u=under + unit: row[o] / row[u])
    for name in OVER_COMPRESS:
        for unit in ("", "_cpu"):
            figures[f"{name}_to_compress{unit}_ratio"] = median(
                lambda row, o=name + unit, u="compress" + unit: row[o] / row[u])
    return figures


def print_tables(figures, megabytes, stored_share):
    print(f"Median of {ROUNDS} rounds; one acquisition of {megabytes:.0f} MB of arrays; simulated rig. "
          f"Programs that wanted one of {os.cpu_count()} cores meanwhile: {os.getloadavg()[0]:.0f}.\n")
    print("| from bytes to | | thermorig | Python | ratio | limit |")
    print("| --- | --- | ---: | ---: | ---: | ---: |")
    for title, name, limit in (("labelled samples", "samples", "10"), ("a finished session", "session", "2.5"),
                               ("the same work: labels, and a file not read back", "same_work", "-")):
        for unit, word in (("", "time"), ("_cpu", "processor")):
            print(f"| {title} | {word} | {figures[f'{name}{unit}_s']:.3f} s | "
                  f"{figures[RATIOS[name][0] + unit + '_s']:.3f} s | {figures[f'{name}{unit}_ratio']:.1f} | "
                  f"{limit if not unit else '-'} |")
            title = ""
    print("\n| file, over compressing its arrays alone | time | processor | limit |")
    print("| --- | ---: | ---: | ---: |")
    for title, name, limit in (("read back before it counts", "file", "1.5"), ("not read back", "file_unread", "-")):
        print(f"| {title} | {figures[name + '_to_compress_ratio']:.2f} | {figures[name + '_to_compress_cpu_ratio']:.2f} | "
              f"{limit} |")
    print("\n| share of a finished session | processor | what it buys |")
    print("| --- | ---: | --- |")
    for title, seconds, buys in shares({key: figures[key + "_cpu_s"] for key in BENCHES.values()}, stored_share):
        print(f"| {title} | {seconds:.3f} s | {buys} |")


def shares(cpu, stored_share):
    """Each was measured alone; clocks and the file's layout are what is left of their whole. `stored_share`: of the
    arrays' bytes, what the file takes."""
    return (("bytes to messages, the first time", cpu["messages"], "what the fits rest on"),
            ("clocks", cpu["fits"] - cpu["turns"] - cpu["offset"] - 2 * cpu["servo"],
             "the time of each message from all chunks and pings, with bounds that hold"),
            ("servo model, before and after the gyro's scale", 2 * cpu["servo"],
             "the shaft's speed while it ramps; the gyro's bias as it goes; legs that contradict their command"),
            ("gyro's scale from whole turns of the images", cpu["turns"], "a gyro that need not be calibrated"),
            ("camera's delay and the order of its rows", cpu["offset"], "frames on the gyro's time, on which the labels hang"),
            ("bytes to labelled samples, with final times", cpu["samples"], "labels, their uncertainty, reasons against them"),
            ("compressing", cpu["compress"], f"a file of {stored_share:.0%} of its arrays"),
            ("laying out, sums of everything, the disk", cpu["file_unread"] - cpu["compress"],
             "a file that any reader of HDF5 explains, and that shows each changed byte"),
            ("reading back", cpu["file"] - cpu["file_unread"],
             "no file gets its name, and no journal goes, before a reader has taken all of it"))


if __name__ == "__main__":
    main(*sys.argv[1:])
