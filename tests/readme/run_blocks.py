# SPDX-License-Identifier: MIT
"""Executes the command blocks of README.md and the tutorial as a newcomer would type them, and stops at the first failure.

    run_blocks.py PROJECT BUILD

Blocks fenced as ```sh run in bash with BUILD/bin on the PATH and the project as working folder (of a throw-away copy of
its tracked files), and print no line beyond 80 columns that could be shorter. Blocks fenced as ```sh hardware name real
ports: they run against `thermorig simulate`, whose three ports take the place of the names given in PORTS. Blocks fenced as
```python run in /usr/bin/python3, on the newest session.
"""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile

WIDTH = 80
PORTS = {"/dev/ttyUSB0": "camera", "/dev/ttyUSB1": "gyro", "/dev/ttyACM0": "servo"}


def blocks(text):
    for match in re.finditer(r"^```(sh hardware|sh|python)\n(.*?)^```$", text, re.M | re.S):
        yield match.group(1), match.group(2), text[: match.start()].count("\n") + 2


def copy_tracked_files(project, target):
    names = subprocess.run(["git", "-C", project, "ls-files", "-z"], check=True, capture_output=True).stdout
    for name in filter(None, names.decode().split("\0")):
        source = pathlib.Path(project, name)
        if source.is_file():
            destination = target / name
            destination.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, destination)


def simulated_ports(folder, environment):
    process = subprocess.Popen(["thermorig", "simulate", "--json"], stdout=subprocess.PIPE, cwd=folder, env=environment,
                               text=True)
    return process, json.loads(process.stdout.readline())


def too_long(output):
    """Lines beyond 80 columns, but for paths and addresses (deg/s is none), which cannot be broken, and what is JSON."""
    for line in output.splitlines():
        shown = line.split("\r")[-1]
        if len(re.sub(r"(?![^ ]*/(s|min)\b)[^ ]*/[^ ]*", "", shown)) > WIDTH and not shown.startswith("{"):
            yield shown


def run(kind, body, folder, environment):
    if kind == "python":
        newest = max(folder.glob("recordings/*/*.h5"), key=os.path.getmtime)
        body = re.sub(r'"recordings/[^"]*\.h5"', repr(str(newest)), body).replace("plt.show()", 'plt.savefig("plot.png")')
        return subprocess.run(["/usr/bin/python3", "-c", body], cwd=folder, env={**environment, "MPLBACKEND": "Agg"})
    process = None
    if kind == "sh hardware":
        process, ports = simulated_ports(folder, environment)
        for name, role in PORTS.items():
            body = body.replace(name, ports[role])
    try:
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", body], cwd=folder, env=environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        print(done.stdout, flush=True)
        lines = [] if "quickstart" in body else list(too_long(done.stdout))  # a compiler's lines are its own
        if lines:
            sys.exit("more than 80 columns:\n" + "\n".join(lines))
        return done
    finally:
        if process:
            process.send_signal(signal.SIGINT)
            process.wait(timeout=10)


def main(project, build):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name, "thermorig")
        copy_tracked_files(project, folder)
        # The quick start builds what the tests were built from: with their preset the compiler's cache has it.
        environment = {**os.environ, "PATH": f"{build}/bin:{os.environ['PATH']}", "THERMORIG_BUILD": f"{folder}/build",
                       "THERMORIG_PRESET": "developer"}
        for document in ("README.md", "docs/tutorial.md"):
            for kind, body, line in blocks(pathlib.Path(project, document).read_text()):
                print(f"{document}:{line} ({kind})\n{body}", flush=True)
                if run(kind, body, folder, environment).returncode != 0:
                    sys.exit(f"{document}:{line}: the block failed")


if __name__ == "__main__":
    main(*sys.argv[1:])
