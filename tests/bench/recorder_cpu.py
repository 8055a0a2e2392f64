# SPDX-License-Identifier: MIT
"""Measures the CPU time of one recording on simulated ports. Used by recorder_cpu.sh: PROGRAM [--json]"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time


def main(program, *options):
    simulate = subprocess.Popen([program, "simulate", "--seed", "3", "--world", "honest", "--environment", "garden", "--json"],
                                stdout=subprocess.PIPE, text=True)
    ports = json.loads(simulate.stdout.readline())
    with tempfile.TemporaryDirectory() as folder:
        start = time.monotonic()
        record = subprocess.Popen([program, "record", "--environment", "garden", "--plan", "quick", "--output", folder,
                                   "--json", *(f"--{role}={ports[role]}" for role in ("camera", "gyro", "servo"))],
                                  stdout=subprocess.PIPE, text=True)
        summary = json.loads(record.stdout.read().splitlines()[-1])
        _, status, usage = os.wait4(record.pid, 0)
        wall_s = time.monotonic() - start
    simulate.send_signal(signal.SIGINT)
    simulate.wait()
    if status != 0:
        sys.exit(f"the recording ended with {os.waitstatus_to_exitcode(status)}: {summary}")
    figures = {"duration_s": round(wall_s, 2), "cpu_s": round(usage.ru_utime + usage.ru_stime, 3),
               "process_cpu_percent": round(100 * (usage.ru_utime + usage.ru_stime) / wall_s, 3)}
    if "--json" in options:
        print(json.dumps(figures))
    else:
        print(f"recorder process: {figures['cpu_s']} s of CPU in {figures['duration_s']} s, "
              f"{figures['process_cpu_percent']} % of one core (simulated rig in a process of its own)")


if __name__ == "__main__":
    main(*sys.argv[1:])
