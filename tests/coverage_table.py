# SPDX-License-Identifier: MIT
"""Lines covered of each module, from a folder with one file of lcov's format a module; exit code 1 if one is below the limit.
MODULE+OTHER: the tests of the other one count for it, too."""

import os
import re
import sys


def lines_of_module(folder, module, *others):
    """(covered, missing) of a module's sources and headers; missing as "file:line"."""
    counts = {}
    own = re.compile(rf"(?:^|/)((?:src|include/thermorig)/(?:[a-z_]+/)?{module}/[^/]+)$")  # behind paths of the build folder
    for tested in (module, *others):
        file = None
        with open(os.path.join(folder, f"{tested}.lcov"), encoding="utf-8") as source:
            for record in source:
                kind, _, rest = record.strip().partition(":")
                if kind == "SF":
                    file = found[1] if (found := own.search(rest)) else None
                elif kind == "DA" and file:
                    line, count = map(int, rest.split(",")[:2])
                    counts[file, line] = counts.get((file, line), 0) + count
    missing = [f"{name}:{line}" for (name, line), count in sorted(counts.items()) if count == 0]
    return len(counts) - len(missing), missing


def main(arguments):
    show = "--missing" in arguments
    folder, least, *modules = [word for word in arguments if word != "--missing"]
    good = True
    print("module    lines  covered")
    for module, *others in (word.split("+") for word in modules):
        covered, missing = lines_of_module(folder, module, *others)
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
