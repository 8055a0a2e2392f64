# SPDX-License-Identifier: MIT
"""Runs both recorders of record_peers.sh in turns and prints their medians.

    record_peers.py RECORD_BENCH SESSION.h5 FOLDER [--json]
"""
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time
import zlib

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
    """Every chunk of every compressed dataset, shuffled as the file's filter does it: what has to be compressed."""
    chunks = []

    def collect(_, item):
        if isinstance(item, h5py.Dataset) and item.compression == "gzip":
            rows = item.chunks[0]
            values = item[:]
            for first in range(0, len(values), rows):
                block = np.ascontiguousarray(values[first : first + rows])
                flat = block.view(np.uint8).reshape(-1, block.dtype.itemsize)
                chunks.append(np.ascontiguousarray(flat.T).tobytes())

    with h5py.File(session) as file:
        file.visititems(collect)
    return chunks


def compress_alone_s(chunks):
    start = time.perf_counter()
    for chunk in chunks:
        zlib.compress(chunk, 4)
    return time.perf_counter() - start


def ours_s(bench, session):
    out = subprocess.run([bench, "--benchmark_format=json", "--benchmark_min_time=0.2"], check=True, capture_output=True,
                         env={**os.environ, "THERMORIG_BENCH_SESSION": str(session)}).stdout
    times = {run["name"].split("/")[0]: run["real_time"] * 1e-3 for run in json.loads(out)["benchmarks"]}
    return times["BytesToLabelledSamples"], times["BytesToFinishedSession"]


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
    rows = {"decode": [], "session": [], "peer_decode": [], "peer_session": [], "compress": []}
    for _ in range(ROUNDS):
        decode, whole = ours_s(bench, session)
        peer = peer_s(folder)
        check_same_work(session, peer)
        for key, value in (("decode", decode), ("session", whole), ("peer_decode", peer["decode_s"]),
                           ("peer_session", peer["session_s"]), ("compress", compress_alone_s(chunks))):
            rows[key].append(value)
    median = {key: statistics.median(values) for key, values in rows.items()}
    figures = {
        "samples_s": median["decode"], "peer_samples_s": median["peer_decode"],
        "samples_ratio": median["peer_decode"] / median["decode"],
        "session_s": median["session"], "peer_session_s": median["peer_session"],
        "session_ratio": median["peer_session"] / median["session"],
        "compress_alone_s": median["compress"], "session_to_compress_ratio": median["session"] / median["compress"],
    }
    if "--json" in options:
        print(json.dumps({key: round(value, 4) for key, value in figures.items()}))
        return
    print(f"median of {ROUNDS} rounds, one acquisition of {sum(map(len, chunks)) / 1e6:.0f} MB of arrays, simulated rig")
    print(f"{'':<28} {'thermorig':>10} {'Python':>10} {'ratio':>7}")
    for title, key in (("bytes -> labelled samples", "samples"), ("bytes -> finished session", "session")):
        print(f"{title:<28} {figures[key + '_s']:>8.3f} s {figures['peer_' + key + '_s']:>8.3f} s "
              f"{figures[key + '_ratio']:>6.1f}x")
    print(f"{'compressing alone (zlib 4)':<28} {figures['compress_alone_s']:>8.3f} s; the finished session takes "
          f"{figures['session_to_compress_ratio']:.2f} times that")


if __name__ == "__main__":
    main(*sys.argv[1:])
