# SPDX-License-Identifier: MIT
"""Runs both recorders of record_peers.sh in turns and prints their medians.

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


def ours_s(bench, session, chunks):
    """By name: from bytes to samples, to the finished session, the fits in that, the writing of its file, compressing its
    arrays alone; the same in seconds of processor."""
    out = subprocess.run([bench, "--benchmark_format=json", "--benchmark_min_time=0.2"], check=True, capture_output=True,
                         env={**os.environ, "THERMORIG_BENCH_SESSION": str(session),
                              "THERMORIG_BENCH_CHUNKS": str(chunks)}).stdout
    names = {"BytesToLabelledSamples": "samples", "BytesToFinishedSession": "session", "FitsOfSession": "fits",
             "SessionToFile": "file", "CompressingAlone": "compress"}
    times = {}
    for run in json.loads(out)["benchmarks"]:
        name = names[run["name"].split("/")[0]]
        times[name], times[name + "_cpu"] = run["real_time"] * 1e-3, run["cpu_time"] * 1e-3
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
                     "peer_samples_cpu": peer["decode_cpu_s"], "peer_session_cpu": peer["session_cpu_s"],
                     "session_without_fits_cpu": ours["session_cpu"] - ours["fits_cpu"]})

    def median(value):
        return statistics.median(value(row) for row in rows)

    figures = {key + "_s": median(lambda row, key=key: row[key]) for key in rows[0]}
    # Of each round, then their median: what slows the computer slows both.
    for key, over, under in (("samples_ratio", "peer_samples", "samples"), ("session_ratio", "peer_session", "session"),
                             ("samples_cpu_ratio", "peer_samples_cpu", "samples_cpu"),
                             ("session_cpu_ratio", "peer_session_cpu", "session_cpu"),
                             ("session_without_fits_cpu_ratio", "peer_session_cpu", "session_without_fits_cpu"),
                             ("file_to_compress_ratio", "file", "compress"),
                             ("session_to_compress_ratio", "session", "compress")):
        figures[key] = median(lambda row, over=over, under=under: row[over] / row[under])
    if "--json" in options:
        print(json.dumps({key: round(value, 4) for key, value in figures.items()}))
        return
    print(f"median of {ROUNDS} rounds, one acquisition of {sum(map(len, chunks)) / 1e6:.0f} MB of arrays, simulated rig")
    print(f"{'':<28} {'thermorig':>10} {'Python':>10} {'ratio':>7}")
    for title, key, peer_key in (("bytes -> labelled samples", "samples", "samples"),
                                 ("  seconds of processor", "samples_cpu", "samples_cpu"),
                                 ("bytes -> finished session", "session", "session"),
                                 ("  seconds of processor", "session_cpu", "session_cpu"),
                                 ("  without the fits", "session_without_fits_cpu", "session_cpu")):
        print(f"{title:<28} {figures[key + '_s']:>8.3f} s {figures['peer_' + peer_key + '_s']:>8.3f} s "
              f"{figures[key + '_ratio']:>6.1f}x")
    print(f"{'compressing alone':<28} {figures['compress_s']:>8.3f} s (same library, level and cores)")
    print(f"{'session -> file':<28} {figures['file_s']:>8.3f} s: {figures['file_to_compress_ratio']:.2f} times that; the "
          f"finished session {figures['session_to_compress_ratio']:.2f} times")


if __name__ == "__main__":
    main(*sys.argv[1:])
