# SPDX-License-Identifier: MIT
"""Called by train_memory.sh: PROGRAM FOLDER ACQUISITIONS MEMORY_MB EPOCHS ROUNDS WORDS JSON."""
import collections
import json
import os
import pathlib
import shutil
import subprocess
import sys
import threading
import time

import process_memory

program, folder, acquisitions, memory_mb, epochs, rounds, words, as_json = sys.argv[1:]
folder = pathlib.Path(folder)
sessions = folder / "sessions"
acquisitions, memory_mb, epochs = int(float(acquisitions)), int(memory_mb), int(epochs)
FRAMES_A_LEG = 442
COLD_EVERY_S = 0.1
figures = {"acquisitions": acquisitions, "memory_mb": memory_mb}

# The system's own h5py, whatever this Python is.
MARK = """
import sys, zlib, h5py
for number, path in enumerate(sys.argv[1:]):
    with h5py.File(path, "r+") as file:
        rates = file["samples/rate_gyro"]
        rates[5] = 1.0 + number / 1024
        rates.attrs.modify("crc32", zlib.crc32(rates[:].tobytes()))
"""


def make_sessions():
    """One simulated session, and copies that differ in the gyro's mean over one frame: train refuses equal ones."""
    (folder / "six.toml").write_text(f"leg_rates_dps = [30, -30, 60, -60, 90, -90]\nframes_per_leg = {FRAMES_A_LEG}\n"
                                     "valid_per_leg = 0\nopening_rest_s = 1\nclosing_rest_s = 1\n")
    subprocess.run([program, "record", "--environment", "garden", "--simulated=3", "--world", "honest", "--fast", "--plan",
                    folder / "six.toml", "--simulated-gyro", "raw", "--output", folder], check=True,
                   stdout=subprocess.DEVNULL)
    [first] = folder.glob("garden/*.h5")
    size = first.stat().st_size
    if shutil.disk_usage(folder).free < acquisitions * (size + 12_000_000) + 2_000_000_000:
        sys.exit(f"{folder}: there is no room for {acquisitions} sessions of {size / 1e6:.0f} MB and as much again; "
                 "try: another --folder, or fewer acquisitions")
    sessions.mkdir()
    paths = [sessions / f"garden_acq-{number:03}.h5" for number in range(acquisitions)]
    for path in paths:
        shutil.copyfile(first, path)
    for begin in range(0, len(paths), 100):
        subprocess.run(["/usr/bin/python3", "-c", MARK.replace("enumerate(sys.argv[1:])",
                                                                f"enumerate(sys.argv[1:], {begin})"),
                        *paths[begin:begin + 100]], check=True)


class ColdDisk:
    """Forgets again and again what the system has kept in memory of the program's file of frames, as a machine does that
    has no memory to spare: each frame comes from the disk then."""

    def __init__(self):
        self.last = 0

    def __call__(self, pid):
        if time.monotonic() - self.last < COLD_EVERY_S:
            return
        self.last = time.monotonic()
        try:
            for entry in os.scandir(f"/proc/{pid}/fd"):
                target = os.readlink(entry.path)
                if target.startswith("/") and target.endswith(" (deleted)") and "/memfd:" not in target:
                    file = os.open(entry.path, os.O_RDONLY)
                    os.posix_fadvise(file, 0, 0, os.POSIX_FADV_DONTNEED)
                    os.close(file)
        except OSError:
            pass  # it has ended


Trained = collections.namedtuple("Trained", "peak_mb held_mb read_s epoch_s epoch_cpu_s")


def processor_s(pid):
    """Of all threads of the process so far; nothing of one that has ended."""
    try:
        words = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return float("nan")
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def lines_of(process, lines):
    """Appends each line's seconds, the process's own seconds and what it says."""
    began = time.monotonic()
    for line in process.stdout:
        lines.append((time.monotonic() - began, processor_s(process.pid), json.loads(line)))


def differences(values):
    return [after - before for before, after in zip(values, values[1:])]


def trained(name, memory, watch=None):
    """What it took, and the model's bytes."""
    model = folder / f"{name}.onnx"
    lines = []
    process = subprocess.Popen([program, "train", sessions, "-o", model, "--epochs", str(epochs), "--memory", str(memory),
                                "--cache", folder, "--json", *words.split()], stdout=subprocess.PIPE, text=True)
    reader = threading.Thread(target=lines_of, args=(process, lines), daemon=True)
    reader.start()
    peak, held = 0, 0
    while process.poll() is None:
        now = process_memory.memory_kb(process.pid)
        peak = max(peak, now.all, process_memory.highest_kb(process.pid))
        held = max(held, now.held)
        if watch:
            watch(process.pid)
        time.sleep(0.02)
    reader.join()
    if process.returncode != 0:
        sys.exit(f"{name} ended with {process.returncode}")
    read_s, _, start = lines[0]
    epochs_of = [line for line in lines if line[2]["event"] in ("start", "epoch")]
    epoch_s = differences([at for at, _, _ in epochs_of])
    epoch_cpu_s = differences([used for _, used, _ in epochs_of])
    figures.setdefault("frames", start["data"]["frames"])
    figures.setdefault("windows", start["data"]["windows"])
    shutil.rmtree(folder / f"{name}.run")
    content = model.read_bytes()
    model.unlink()
    print(f"{name}: {peak / 1e3:.0f} MB, {held / 1e3:.0f} of them held, read in {read_s:.1f} s, epochs of "
          f"{', '.join(f'{s:.1f}' for s in epoch_s)} s", file=sys.stderr, flush=True)
    return Trained(peak / 1e3, held / 1e3, read_s, min(epoch_s), min(epoch_cpu_s)), content


make_sessions()
EVERYTHING_MB = 100_000_000
runs = {"memory": [], "disk": [], "cold_disk": []}
models = set()
for _ in range(int(rounds)):
    for name, memory, watch in (("memory", EVERYTHING_MB, None), ("disk", memory_mb, None),
                                ("cold_disk", memory_mb, ColdDisk())):
        run, content = trained(name, memory, watch)
        runs[name].append(run)
        models.add(content)
for name, of_name in runs.items():
    figures[f"{name}_peak_mb"] = round(max(run.peak_mb for run in of_name), 1)
    figures[f"{name}_held_mb"] = round(max(run.held_mb for run in of_name), 1)
    for figure in ("read_s", "epoch_s", "epoch_cpu_s"):
        figures[f"{name}_{figure}"] = round(min(getattr(run, figure) for run in of_name), 2)
for name in ("disk", "cold_disk"):
    for figure in ("epoch_s", "epoch_cpu_s"):
        ratio = figures[f"{name}_{figure}"] / figures[f"memory_{figure}"]
        figures[f"{name}_{figure[:-2]}_more_percent"] = round(100 * (ratio - 1), 1)
figures["different_models"] = len(models)
if as_json:
    print(json.dumps(figures))
else:
    for name, figure in figures.items():
        print(f"{name:24} {figure}")
