# SPDX-License-Identifier: MIT
"""One training of 40 epochs: from the step's time, and really. Called by network_speed.sh.

    speed.py BIN_FOLDER SESSIONS|"" [--json]
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import time

from measure import Worker, run_in_turn

WINDOWS, BATCH, EPOCHS = 51561, 32, 40
ROUNDS = 9


def step_us(binaries, folder):
    model = folder / "model.onnx"
    subprocess.run([binaries / "network_interop", "seeded-model", "3", "1", "fusion", "100", model], check=True)
    worker = Worker(binaries / "network_peer_ours", model, "serve")
    times = run_in_turn({"ours": (worker, ("train",))}, ROUNDS)
    worker.close()
    return times["ours", "train"]["processor_us"]


def train(binaries, sessions, folder):
    """Seconds that `thermorig train` takes on the sessions, reading them included."""
    begin = time.perf_counter()
    subprocess.run([binaries / "thermorig", "train", sessions, "--preset", "paper", "--threads", "1", "--output",
                    folder / "trained.onnx"], check=True, stdout=sys.stderr)
    return time.perf_counter() - begin


def main(binaries, sessions, *options):
    binaries = pathlib.Path(binaries)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        step = step_us(binaries, folder)
        steps = math.ceil(WINDOWS / BATCH) * EPOCHS
        figures = {"train_step_us": step, "steps_of_40_epochs": steps, "training_of_40_epochs_s": step * 1e-6 * steps}
        if sessions:
            figures["real_training_of_40_epochs_s"] = train(binaries, sessions, folder)
    if "--json" in options:
        print(json.dumps(figures, indent=1))
    else:
        for key, value in figures.items():
            print(f"{key:32} {value:10.1f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
