# SPDX-License-Identifier: MIT
"""clang-tidy over the lines of src, app, include and firmware_servo that differ from a commit.

Usage: python3 tests/tidy.py BUILD_FOLDER [COMMIT | --all]   (default: where this branch left origin/main, or the commit
before; --all: every line)
Files that are compiled together are read together: a header is parsed once, not once for each of a dozen files.
Exit code 1: a finding.
"""

import json
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = ("src", "app", "include", "firmware_servo")
SUFFIXES = (".cpp", ".c", ".h")


def git(*words):
    return subprocess.run(("git", "-C", ROOT, *words), check=True, capture_output=True, text=True).stdout


def default_base():
    for name in ("origin/main", "HEAD~1"):
        try:
            base = git("merge-base", "HEAD", name).strip()
        except subprocess.CalledProcessError:
            continue
        if base != git("rev-parse", "HEAD").strip():
            return base
    return "HEAD"


def changed_lines(base):
    """{path: [[first, last], ...]} of lines that were added or changed since `base`, uncommitted ones included."""
    lines, path = {}, None
    for line in git("diff", "-U0", base, "--", *FOLDERS).splitlines():
        if line.startswith("+++ "):
            path = line[6:] if line.startswith("+++ b/") else None
        elif path and (hunk := re.match(r"@@ -\S+ \+(\d+)(?:,(\d+))? @@", line)):
            first, count = int(hunk[1]), int(hunk[2] or 1)
            if count and path.endswith(SUFFIXES):
                lines.setdefault(path, []).append([first, first + count - 1])
    return lines


def all_lines():
    return {path: [[1, 1_000_000]] for path in git("ls-files", *FOLDERS).splitlines() if path.endswith(SUFFIXES)}


def sources_of(unit):
    """The files that one compiled file holds: itself, or what a unity file includes."""
    if "/Unity/" not in unit:
        return {os.path.relpath(unit, ROOT)}
    included = re.findall(r'#include "(.+?)"', Path(unit).read_text(encoding="utf-8"))
    return {os.path.relpath(path, ROOT) for path in included}


def units_of(build, paths):
    """The compiled files that have one of `paths`; a header is looked for in the folder that it belongs to."""
    folders = {re.sub(r"^include/thermorig/", "src/", os.path.dirname(path)) for path in paths if path.endswith(".h")}
    units = []
    for entry in json.loads((Path(build) / "compile_commands.json").read_text(encoding="utf-8")):
        sources = sources_of(entry["file"])
        if sources & paths.keys() or any(os.path.dirname(source) in folders for source in sources):
            units.append(entry["file"])
    return sorted(set(units))


def check(build, unit, lines):
    line_filter = json.dumps([{"name": path, "lines": ranges} for path, ranges in lines.items()])
    done = subprocess.run(("clang-tidy-14", "-p", build, "--quiet", "--header-filter=.*",
                           f"--line-filter={line_filter}", "--extra-arg=-Wno-unknown-warning-option", unit), capture_output=True, text=True, cwd=ROOT)
    return done.returncode, done.stdout.strip() or (done.stderr.strip() if done.returncode else "")


def main(arguments):
    if not arguments:
        print(__doc__, file=sys.stderr)
        return 2
    build = arguments[0]
    if arguments[1:] == ["--all"]:
        lines = all_lines()
    else:
        lines = changed_lines(arguments[1] if len(arguments) > 1 else default_base())
    units = units_of(build, lines)
    seen = set().union(*(sources_of(unit) for unit in units)) if units else set()
    for path in sorted(path for path in lines if path.endswith((".cpp", ".c")) and path not in seen):
        print(f"not read: {path} is compiled in no part of {build}")
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda unit: check(build, unit, lines), units))
    failed = [text for code, text in results if code]
    for text in dict.fromkeys(failed):
        print(text)
    print(f"clang-tidy: {len(lines)} files, read in {len(units)} parts, "
          f"{'findings above' if failed else 'no finding'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
