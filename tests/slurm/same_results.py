#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Are two folders of results the same, but for the seconds that jobs took? Nothing else may lie in them.

Usage: same_results.py FOLDER OTHER
"""
import json
import pathlib
import sys


def results_of(folder):
    """File names to what the files hold, without seconds."""
    results = {}
    for path in sorted(pathlib.Path(folder).iterdir()):
        if path.suffix != ".json":
            sys.exit(f"{path} is no result: an unfinished file was left")
        result = json.loads(path.read_text())
        for name in ("seconds", "sum"):  # of one training they differ
            del result[name]
        results[path.name] = result
    return results


one, other = results_of(sys.argv[1]), results_of(sys.argv[2])
if one != other:
    differing = [name for name in sorted(one.keys() | other.keys()) if one.get(name) != other.get(name)]
    sys.exit("not the same: " + ", ".join(differing))
print(f"{len(one)} results are the same")
