# SPDX-License-Identifier: MIT
"""Memory of a process and its children together, by the system's count: what they hold for themselves, mapped pages of
files, and files that lie in memory, mapped or not. What a child that was forked off shares with its parent is its parent's.
Pages of files on disks the system takes back when memory runs short; all else is held."""
import collections
import os
import pathlib
import subprocess
import time

LOOK_EVERY_S = 0.005


def tree_of(pid):
    """The process, and all below it."""
    pids = [pid]
    for parent in pids:
        try:
            for task in os.listdir(f"/proc/{parent}/task"):
                pids += map(int, pathlib.Path(f"/proc/{parent}/task/{task}/children").read_text().split())
        except OSError:
            pass  # it has ended
    return pids


def status_kb(pid, *names):
    """Figures of the process, in the order of the names."""
    lines = dict(line.split(":", 1) for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines())
    return [int(lines[name].split()[0]) for name in names if name in lines]  # one that has ended has none


def private_kb(pid):
    """What it shares with nobody."""
    lines = pathlib.Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    return [int(line.split()[1]) for line in lines if line.startswith("Private_Dirty")]


Memory = collections.namedtuple("Memory", "all held")
Run = collections.namedtuple("Run", "all_mb held_mb seconds code")


def files_in_memory(pid):
    """Size by inode, kB."""
    sizes = {}
    for entry in os.scandir(f"/proc/{pid}/fd"):
        if "memfd:" in os.readlink(entry.path):
            status = os.stat(entry.path)
            sizes[status.st_ino] = status.st_blocks // 2
    return sizes


def memory_kb(pid):
    """Of the process and all below it."""
    own, of_files, in_memory = 0, 0, {}
    for one in tree_of(pid):
        try:
            own += sum(status_kb(one, "RssAnon") if one == pid else private_kb(one))
            of_files += sum(status_kb(one, "RssFile"))
            in_memory.update(files_in_memory(one))
        except OSError:
            pass
    held = own + sum(in_memory.values())
    return Memory(held + of_files, held)


def highest_kb(pid):
    """The most that one of them had in memory at any time, also between two looks."""
    highest = 0
    for one in tree_of(pid):
        try:
            highest = max([highest, *status_kb(one, "VmHWM")])
        except OSError:
            pass
    return highest


def run(command, watch=None, **options):
    """Peaks in MB, seconds and exit code; `watch` is called at each look."""
    began = time.monotonic()
    process = subprocess.Popen(command, **options)
    peak, held = 0, 0
    while process.poll() is None:
        now = memory_kb(process.pid)
        peak = max(peak, now.all, highest_kb(process.pid))
        held = max(held, now.held)
        if watch:
            watch()
        time.sleep(LOOK_EVERY_S)
    return Run(peak / 1e3, held / 1e3, time.monotonic() - began, process.returncode)
