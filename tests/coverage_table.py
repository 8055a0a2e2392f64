# SPDX-License-Identifier: MIT
"""Lines covered of each module, from gcovr's JSON; exit code 1 if one is below the limit."""

import json
import sys


def lines_of_module(report, module):
    """(covered, missing) of a module's sources and headers; missing as "file:line"."""
    covered, missing = 0, []
    folders = (f"src/{module}/", f"include/thermorig/{module}/")
    for file in report["files"]:
        if not file["file"].startswith(folders):
            continue
        counts = {}  # a template's line stands once for each instance
        for line in file["lines"]:
            if not line.get("gcovr/noncode"):
                counts[line["line_number"]] = counts.get(line["line_number"], 0) + line["count"]
        covered += sum(1 for count in counts.values() if count > 0)
        missing += [f"{file['file']}:{number}" for number, count in sorted(counts.items()) if count == 0]
    return covered, missing


def main(arguments):
    show = "--missing" in arguments
    path, least, *modules = [word for word in arguments if word != "--missing"]
    with open(path, encoding="utf-8") as source:
        report = json.load(source)
    good = True
    print("module    lines  covered")
    for module in modules:
        covered, missing = lines_of_module(report, module)
        total = covered + len(missing)
        share = 100.0 * covered / total if total else 0.0
        good = good and share >= float(least)
        print(f"{module:8} {total:6} {share:6.1f} %")
        if show:
            print("".join(f"  {place}\n" for place in missing), end="")
    if not good:
        print(f"less than {least} % of a module's lines are covered; bash tests/coverage.sh --missing lists them",
              file=sys.stderr)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
