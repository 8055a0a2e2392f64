# SPDX-License-Identifier: MIT
"""Writes a study's report into the place that docs/paper_study.md keeps for it.

Usage: paper_study_tables.py PAGE.md NAME REPORT.md
The place lies between the lines "<!-- begin NAME -->" and "<!-- end NAME -->".
"""
import os
import pathlib
import re
import sys


def nested(report):
    """The report without its title, its headings below those of the page."""
    body = report.split("\n", 1)[1].strip()
    return re.sub(r"^## ", "### ", body, flags=re.MULTILINE)


def main(page_path, name, report_path):
    page = pathlib.Path(page_path)
    text = page.read_text(encoding="utf-8")
    begin, end = f"<!-- begin {name} -->\n", f"<!-- end {name} -->"
    if text.count(begin) != 1 or text.count(end) != 1:
        sys.exit(f"{page}: one place for {name} is needed, between '{begin.strip()}' and '{end}'")
    head, rest = text.split(begin)
    tail = rest.split(end)[1]
    report = pathlib.Path(report_path).read_text(encoding="utf-8")
    part = page.with_suffix(".part")
    part.write_text(head + begin + "\n" + nested(report) + "\n\n" + end + tail, encoding="utf-8")
    os.replace(part, page)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
