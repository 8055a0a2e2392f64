#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Holds the option tables of docs/commands.md against the program, or writes them anew.

Usage: python3 tests/commands_document.py PROGRAM [--check]
"""
import pathlib
import re
import subprocess
import sys

document = pathlib.Path(__file__).resolve().parent.parent / "docs/commands.md"
block = re.compile(r"<!-- options: ([a-z ]+) -->\n.*?<!-- end of options -->\n", re.DOTALL)


def main():
    program = sys.argv[1]
    printed = subprocess.run([program, "help", "--tables"], check=True, capture_output=True, text=True).stdout
    tables = {found[1]: found[0] for found in block.finditer(printed)}
    old = document.read_text()
    named = {found[1] for found in block.finditer(old)}
    if named != set(tables):
        sys.exit(f"docs/commands.md and the program differ in their commands: {sorted(named ^ set(tables))}\n"
                 "  try: a section for each command, with the marks '<!-- options: NAME -->' and "
                 "'<!-- end of options -->'")
    new = block.sub(lambda found: tables[found[1]], old)
    if new == old:
        return
    if "--check" in sys.argv:
        changed = sorted(name for name in tables if tables[name] not in old)
        sys.exit(f"docs/commands.md has other options than the program: {', '.join(changed)}\n"
                 f"  try: python3 tests/commands_document.py {program}")
    document.write_text(new)


main()
