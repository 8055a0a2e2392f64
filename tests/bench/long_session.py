# SPDX-License-Identifier: MIT
"""Called by long_session.sh: PROGRAM FOLDER HOURS JSON."""
import json
import os
import pathlib
import re
import subprocess
import sys
import time
import urllib.request

import process_memory

program, folder, hours, as_json = sys.argv[1:]
folder = pathlib.Path(folder)
FRAMES_PER_S = 8
figures = {"hours": float(hours)}


def measured(name, arguments, **options):
    run = process_memory.run([program, *arguments], stdout=subprocess.DEVNULL, **options)
    if run.code != 0:
        sys.exit(f"{name} ended with {run.code}")
    figures[f"{name}_peak_mb"], figures[f"{name}_held_mb"] = round(run.all_mb, 1), round(run.held_mb, 1)
    figures[f"{name}_s"] = round(run.seconds, 1)
    print(f"{name}: {run.all_mb:.1f} MB, {run.held_mb:.1f} of them held, {run.seconds:.1f} s", file=sys.stderr, flush=True)


def keep_journal():
    """A second name of the journal, before the recorder removes the first."""
    if kept.exists():
        return
    for journal in folder.glob("long/*.journal"):
        os.link(journal, kept)


def seconds_until_shown(session):
    """Until the page has all it needs to show the first frame."""
    began = time.monotonic()
    viewer = subprocess.Popen([program, "view", session, "--page-port", "0"], stdout=subprocess.PIPE, text=True)
    address = next(match for line in viewer.stdout if (match := re.search(r"(http://[^/]+)/#t=(\w+)", line)))
    for name in ("facts", "rows", "images/0"):
        request = urllib.request.Request(f"{address[1]}/data/{name}", headers={"Authorization": f"Bearer {address[2]}"})
        urllib.request.urlopen(request).read()
    shown = time.monotonic() - began
    figures["view_peak_mb"] = round(process_memory.memory_kb(viewer.pid).all / 1e3, 1)
    viewer.terminate()
    viewer.wait()
    return shown


# Two legs of 90 deg/s, back and forth.
frames = int(3600 * float(hours) * FRAMES_PER_S / 2)
(folder / "long.toml").write_text(f"leg_rates_dps = [90, -90]\nframes_per_leg = {frames}\nvalid_per_leg = 0\n"
                                  "opening_rest_s = 1\nclosing_rest_s = 1\n")
kept = folder / "kept" / "long.journal"
kept.parent.mkdir()
measured("record", ["record", "--environment", "long", "--simulated=3", "--world", "honest", "--fast", "--plan",
                    folder / "long.toml", "--output", folder], watch=keep_journal)
[session] = folder.glob("long/*.h5")
figures["session_mb"] = round(session.stat().st_size / 1e6, 1)
measured("recover", ["recover", kept])
measured("inspect", ["inspect", session])
measured("list", ["list", session.parent])
for form in ("csv", "npz", "mcap"):
    measured(f"export_{form}", ["export", session, f"--{form}", "-o", "-"])
figures["view_s"] = round(seconds_until_shown(session), 2)
measured("reprocess", ["reprocess", session])
if as_json:
    print(json.dumps(figures))
else:
    for name, figure in figures.items():
        print(f"{name:20} {figure}")
