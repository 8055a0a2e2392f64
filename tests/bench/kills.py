# SPDX-License-Identifier: MIT
"""Kills recordings and counts what recovery brings back. Called by kills.sh."""
import argparse
import concurrent.futures
import json
import os
import pathlib
import random
import signal
import struct
import subprocess
import sys
import tempfile
import time

import h5py

LEDGER_PORTS = 1024  # tests/acceptance/read_ledger.h: two u64 each, bytes of all reads and of the last one
PLAN = 'magnitudes_dps = [90.0, 45.0]\norder = "given"\nframes_per_leg = {}\nopening_rest_s = 0.3\nclosing_rest_s = 0.3\n'
# Frames a leg, and when it is killed after the journal has appeared: anywhere in a recording, which has its first valid frame
# after some 5 s; or only where it has one.
ANYWHERE = (10, 0.0, 9.0)
SWEEPING = (25, 8.0, 16.0)
DEVICES = ("camera", "gyro", "servo")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("count", type=int, nargs="?", default=500)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--sweeping", dest="moments", action="store_const", const=SWEEPING, default=ANYWHERE)
    return parser.parse_args()


def files(folder, suffix):
    return sorted((folder / "recordings").glob(f"**/*{suffix}"))


def ledger_of(folder):
    """(bytes read, bytes of the last read) by the number of the port."""
    words = struct.unpack(f"<{2 * LEDGER_PORTS}Q", (folder / "ledger").read_bytes())
    return {port: (words[2 * port], words[2 * port + 1]) for port in range(LEDGER_PORTS) if words[2 * port]}


def start(program, ledger, folder, number, frames):
    (folder / "ledger").write_bytes(bytes(16 * LEDGER_PORTS))
    (folder / "plan.toml").write_text(PLAN.format(frames))
    environment = dict(os.environ, LD_PRELOAD=str(ledger), THERMORIG_READ_LEDGER=str(folder / "ledger"))
    words = [program, "record", f"--simulated={number + 1}", "--world", "honest", "--environment", "garden", "--plan", "plan.toml", "--no-preflight"]
    with (folder / "errors.txt").open("wb") as errors:
        return subprocess.Popen(words, cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=errors, stdin=subprocess.DEVNULL)


def kill_somewhere(process, folder, moment, first_s, last_s):
    """Anywhere within a start in one of ten runs where that may be, else between these times after the journal's creation."""
    if first_s == 0.0 and moment.random() < 0.1:
        time.sleep(moment.uniform(0.0, 1.0))
    else:
        while process.poll() is None and not files(folder, ".journal"):
            time.sleep(0.002)
        time.sleep(moment.uniform(first_s, last_s))
    process.send_signal(signal.SIGKILL)
    return process.wait() == -signal.SIGKILL


def compare(session, ledger):
    """What is wrong with a recovered session, and the largest loss in bytes."""
    wrong, worst = [], 0
    with h5py.File(session, "r") as file:  # stock, no flag
        for device in DEVICES:
            port = file["rig/profile"][device].attrs["port"]
            port = port.decode() if isinstance(port, bytes) else port
            kept = file["raw"][device]["bytes"].shape[0]
            read, last = ledger.get(int(port.rsplit("/", 1)[1]), (0, 0))
            worst = max(worst, read - kept)
            if not read - last <= kept <= read:
                wrong.append(f"{device}: {kept} bytes kept of {read}, the last read had {last}")
    return wrong, worst


def valid_frames(session):
    with h5py.File(session, "r") as file:
        return int(file["samples"]["valid"][()].sum())


def one(options, number):
    moment = random.Random(options.seed * 1_000_003 + number)
    program = str((options.build / "bin" / "thermorig").resolve())
    (preload,) = options.build.glob("**/libread_ledger.so")
    result = {"number": number, "wrong": [], "lost_bytes": 0, "session": False, "check": None, "valid": 0}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        frames, first_s, last_s = options.moments
        process = start(program, preload.resolve(), folder, number, frames)
        result["killed"] = kill_somewhere(process, folder, moment, first_s, last_s)
        ledger = ledger_of(folder)
        (folder / "recordings").mkdir(exist_ok=True)
        recovery = subprocess.run([program, "recover", "recordings", "--json"], cwd=folder, capture_output=True, text=True)
        result["recover"] = recovery.returncode
        if recovery.returncode not in (0, 3):
            result["wrong"].append(f"recover: {recovery.returncode} {recovery.stderr.strip()}")
        sessions = files(folder, ".h5")
        if sessions:
            result["session"] = True
            result["wrong"], result["lost_bytes"] = compare(sessions[0], ledger)
            check = subprocess.run([program, "inspect", str(sessions[0]), "--check"], cwd=folder, capture_output=True)
            result["check"] = check.returncode
            result["valid"] = valid_frames(sessions[0])
            if (check.returncode == 0) != (result["valid"] > 0):
                verdict = [line for line in check.stdout.decode().splitlines() if line.startswith("verdict")]
                result["wrong"].append(f"inspect --check: {check.returncode} with {result['valid']} valid frames, {verdict}")
        elif any(read > last for read, last in ledger.values()):
            result["wrong"].append(f"no session ({'killed' if result['killed'] else (folder / 'errors.txt').read_text()}), although more was read than a "
                                   f"chunk of each port: {ledger}")
        if len(sessions) > 1 or files(folder, ".part") or (files(folder, ".journal") and recovery.returncode != 3):
            result["wrong"].append("something was left lying about")
    return result


def summary(results):
    sessions = [result for result in results if result["session"]]
    return {
        "runs": len(results),
        "killed": sum(result["killed"] for result in results),
        "sessions": len(sessions),
        "killed_before_anything_was_kept": sum(result["killed"] and not result["session"] for result in results),
        "torn_records": sum(result["recover"] == 3 for result in results),
        "largest_loss_bytes": max((result["lost_bytes"] for result in sessions), default=0),
        "sessions_without_a_valid_frame": sum(result["valid"] == 0 for result in sessions),
        "inspect_check": {str(code): sum(result["check"] == code for result in sessions)
                          for code in sorted({result["check"] for result in sessions})},
        "wrong": [result for result in results if result["wrong"]],
    }


def main():
    options = arguments()
    results = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as workers:
        runs = [workers.submit(one, options, number) for number in range(options.count)]
        try:
            for run in concurrent.futures.as_completed(runs):
                results.append(run.result())
        except KeyboardInterrupt:  # what was done until then counts
            workers.shutdown(wait=False, cancel_futures=True)
    total = summary(results)
    if options.json:
        print(json.dumps(total, indent=2))
    else:
        print(f"{total['runs']} recordings, {total['killed']} killed; {total['sessions']} sessions open with stock h5py, "
              f"{total['killed_before_anything_was_kept']} killed before a session could be made")
        print(f"largest loss: {total['largest_loss_bytes']} bytes of a port; torn records: {total['torn_records']}")
        print("inspect --check, by exit code: " + ", ".join(f"{code}: {n}" for code, n in total["inspect_check"].items())
              + f"; {total['sessions_without_a_valid_frame']} were killed before the first valid frame, which is a bad verdict")
        for result in total["wrong"]:
            print(f"WRONG  {result['number']}: {'; '.join(result['wrong'])}")
    return 1 if total["wrong"] else 0


sys.exit(main())
