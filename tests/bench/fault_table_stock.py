# SPDX-License-Identifier: MIT
"""Opens recovered sessions with stock h5py, plainly, and holds the raw bytes against what must be there.

Usage: python3 fault_table_stock.py FOLDER    (FOLDER/*.h5 with *.h5.expected: device, chunks, bytes)
"""
import pathlib
import sys

import h5py


def check(path):
    with h5py.File(path, "r") as session:
        assert session.attrs["format"] in ("thermorig-session", b"thermorig-session")
        for line in pathlib.Path(str(path) + ".expected").read_text().splitlines():
            device, chunks, size = line.split()
            raw = session["raw"][device]
            assert raw["bytes"].shape[0] == int(size), (device, raw["bytes"].shape, size)
            assert raw["chunk_end"].shape[0] == int(chunks), (device, raw["chunk_end"].shape, chunks)
            assert len(raw["bytes"][()]) == int(size)


def main():
    files = sorted(pathlib.Path(sys.argv[1]).glob("*.h5"))
    for path in files:
        check(path)
    print(f"{len(files)} recovered sessions open with stock h5py {h5py.__version__}, no flag, every raw byte is there")


main()
