# SPDX-License-Identifier: MIT
"""Breaks the program in places that a seed draws, and says which tests notice. Used by mutations.sh.

All breaks are compiled into one program: each is a branch that THERMORIG_MUTANT=<number> takes, so that the program is
built once, not once for each. A break is one of
  negate    a condition is turned round, or one of its comparisons or its "and" and "or" is another
  return    the sum, the comparison or the truth that a function returns is another
  change    a sum is added to instead of taken from, and the like
  skip      an assignment or a call is left out

mutations.py draw SEED FOLDER          writes the list to standard output; FOLDER: the checkout
mutations.py apply LIST FOLDER         puts the breaks into the sources of FOLDER
mutations.py run LIST FOLDER BUILD [--json]   runs the tests against each
"""

import json
import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

# How many breaks, and where. What is near is tried first: its own test programs.
AREAS = {
    "wire": (3, ["src/sensors/wire/*.cpp", "src/sensors/*.cpp"], ["wire", "sensors"]),
    "timing": (3, ["src/pipeline/timing/*.cpp"], ["timing"]),
    "labels": (3, ["src/pipeline/labels/*.cpp"], ["labels"]),
    "journal": (3, ["src/storage/journal/*.cpp"], ["journal", "storage"]),
    "session": (2, ["src/storage/session/*.cpp"], ["session"]),
    "sweep": (2, ["src/rig/sweep/*.cpp"], ["rig"]),
    "live": (2, ["src/estimators/live/*.cpp"], ["live"]),
    "web": (2, ["src/io/web/*.cpp"], ["web", "web_server"]),
}
OTHER_OPERATOR = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&",
                  "+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+="}
HEADER = """#pragma once
#include <cstdlib>
inline bool mutant_is(int number) {
  static const int chosen = [] {
    const char* text = std::getenv("THERMORIG_MUTANT");
    return text == nullptr ? 0 : std::atoi(text);
  }();
  return chosen == number;
}
"""


def balanced(text):
    depth = 0
    for letter in text:
        depth += (letter in "([{") - (letter in ")]}")
        if depth < 0:
            return False
    return depth == 0


def other_expressions(text, operators):
    """`text` with one operator exchanged, for each one that stands between spaces."""
    for found in re.finditer(r"(?<= )(" + "|".join(re.escape(o) for o in operators) + r")(?= )", text):
        yield text[:found.start()] + OTHER_OPERATOR[found[0]] + text[found.end():]


def breaks_of_line(line):
    """(kind, what the line becomes with %M% for "this break is chosen") for each way to break it."""
    comparisons = ["<", "<=", ">", ">=", "==", "!=", "&&", "||"]
    if found := re.fullmatch(r"(\s*(?:\} else )?if \()([^;]+)(\)(?: \{| [^{].*;)?)", line):
        head, condition, tail = found.groups()
        if not balanced(condition) or "constexpr" in head:
            return
        for other in [f"!({condition})", *other_expressions(condition, comparisons)]:
            yield "negate", f"{head}%M% ? ({other}) : ({condition}){tail}"
    elif found := re.fullmatch(r"(\s+)return (.+);", line):
        indent, value = found.groups()
        if not balanced(value) or value.startswith("{"):
            return
        others = list(other_expressions(value, [*comparisons, "+", "-", "*", "/"]))
        others += {"true": ["false"], "false": ["true"]}.get(value, [])
        for other in others:
            yield "return", f"{indent}{{ if (%M%) return {other}; return {value}; }}"
    elif found := re.fullmatch(r"(\s+)([\w.>\[\]()-]+) (\+=|-=) (.+);", line):
        indent, left, sign, value = found.groups()
        if balanced(left) and balanced(value):
            yield "change", f"{indent}{{ if (%M%) {left} {OTHER_OPERATOR[sign]} {value}; else {left} {sign} {value}; }}"
    elif found := re.fullmatch(r"(\s+)([\w.>\[\]-]+ = .+|[\w.>:-]+\(.*\));", line):
        indent, statement = found.groups()
        if balanced(statement) and not statement.startswith(("return", "throw", "static_assert", "assert", "co_", "using")):
            yield "skip", f"{indent}{{ if (!%M%) {statement}; }}"


def in_a_function_at_run_time(lines, index):
    """Whether the line stands in the body of a function that is not constexpr."""
    for line in reversed(lines[:index]):
        if line and not line[0].isspace() and line[0] not in "}/#":
            return "(" in line and not re.search(r"\b(constexpr|consteval|struct|class|enum|template)\b", line)
    return False


def candidates(folder, patterns):
    for pattern in patterns:
        for path in sorted(Path(folder).glob(pattern)):
            lines = path.read_text(encoding="utf-8").splitlines()
            for index, line in enumerate(lines):
                if not in_a_function_at_run_time(lines, index):
                    continue
                for kind, becomes in breaks_of_line(line):
                    yield {"file": str(path.relative_to(folder)), "kind": kind, "line": line, "becomes": becomes,
                           "occurrence": lines[:index].count(line)}


def draw(seed, folder):
    """In the order of the draw; more than are run, for those that turn out to change nothing."""
    for area, (count, patterns, _) in AREAS.items():
        drawn = list(candidates(folder, patterns))
        random.Random(f"{seed} {area}").shuffle(drawn)
        places = set()
        for one in drawn:
            place = (one["file"], one["line"], one["occurrence"])
            if place not in places and len(places) < 3 * count:
                places.add(place)
                yield {"area": area, **one}


def chosen(path):
    """The breaks that are run: of each area the first so many that are not left out."""
    left = {area: count for area, (count, _, _) in AREAS.items()}
    with open(path, encoding="utf-8") as source:
        for line in source:
            one = json.loads(line)
            if "left_out" in one or left[one["area"]] == 0:
                continue
            left[one["area"]] -= 1
            yield one


def apply(path, folder):
    by_file = {}
    for number, one in enumerate(chosen(path), 1):
        by_file.setdefault(one["file"], []).append((number, one))
    for file, breaks in by_file.items():
        lines = Path(folder, file).read_text(encoding="utf-8").splitlines()
        places = []
        for number, one in breaks:
            found = [index for index, line in enumerate(lines) if line == one["line"]]
            if len(found) <= one["occurrence"]:
                sys.exit(f"{file} has no line any more that reads {one['line']!r}: draw another list "
                         f"(tests/bench/mutations.sh --draw SEED)")
            places.append((found[one["occurrence"]], one["becomes"].replace("%M%", f"mutant_is({number})")))
        for index, becomes in places:
            lines[index] = becomes
        Path(folder, file).write_text('#include "mutant.h"\n' + "\n".join(lines) + "\n", encoding="utf-8")
    Path(folder, "include/mutant.h").write_text(HEADER, encoding="utf-8")


def run_tests(command, folder, environment, output, limit_s):
    """Its exit code, or None where it did not end in time: then everything that it started is ended."""
    process = subprocess.Popen(command, cwd=folder, env=environment, stdout=output, stderr=subprocess.STDOUT,
                               start_new_session=True)
    try:
        return process.wait(limit_s)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return None


def finds(command, folder, number, log, limit_s=900.0):
    """The first test that failed, or None."""
    environment = {**os.environ, "THERMORIG_MUTANT": str(number), "GTEST_FAIL_FAST": "1"}
    with open(log, "w", encoding="utf-8") as output:
        code = run_tests(command, folder, environment, output, limit_s)
    if code is None:
        return "hangs"
    if code == 0:
        return None
    text = Path(log).read_text(encoding="utf-8", errors="replace")
    found = re.search(r"\[  FAILED  \] ([\w/]+\.[\w/]+)|Test +#\d+: (\S+) \.*\*{3}|\d+ - (\S+) \(", text)
    return next((name for name in found.groups() if name), "") if found else f"exit code {code}"


def with_sanitizers(names, folder):
    """The programs of these tests, built with AddressSanitizer and UBSan: they see leaks and what lies out of bounds."""
    targets = [f"test_{name}" for name in names]
    with open(f"{folder}/asan.log", "a", encoding="utf-8") as log:
        for command in (["cmake", "--preset", "asan", "-DTHERMORIG_WERROR=OFF"],
                        ["cmake", "--build", "--preset", "asan", "-j", str(os.cpu_count()), "--target", *targets]):
            subprocess.run(command, cwd=folder, check=True, stdout=log, stderr=log)
    return "build-asan"


def program(build, name, clock):
    return [f"{build}/bin/test_{name}", "--gtest_brief=1", f"--gtest_filter=-{clock}"]


def limit_of(suite, command, folder, log, limits):
    """How long it may take with a break, seconds. Ends the program where it fails without any."""
    if suite not in limits:
        begin = time.monotonic()
        failed = finds(command, folder, 0, log)
        if failed is not None:
            sys.exit(f"{suite} fails without a break: {failed} ({log})")
        limits[suite] = 60.0 + 5.0 * (time.monotonic() - begin)
    return limits[suite]


def suites_of(names, folder, build, clock, every):
    """(name, command) of each suite, the nearest first. What sanitizers need is built only where it is come to."""
    yield from ((f"test_{name}", program(build, name, clock)) for name in names)
    sanitized = with_sanitizers(names, folder)
    yield from ((f"test_{name} with sanitizers", program(sanitized, name, clock)) for name in names)
    yield from every


def run(path, folder, build, form):
    clock = ":".join(Path(folder, "tests/on_the_clock.txt").read_text(encoding="utf-8").split())
    every = [("unit", ["ctest", "--test-dir", build, "-LE", "rig", "--stop-on-failure", "-j", str(os.cpu_count())]),
             ("on the clock", ["bash", "tests/wall_clock.sh", build, "-L", "rig", "-E", "^Readme"])]
    results, limits = [], {}
    for number, one in enumerate(chosen(path), 1):
        begin = time.monotonic()
        names = AREAS[one["area"]][2]
        suite, test = "", None
        for suite, command in suites_of(names, folder, build, clock, every):
            test = finds(command, folder, number, f"{build}/mutant-{number}.log",
                         limit_of(suite, command, folder, f"{build}/unbroken.log", limits))
            if test is not None:
                break
        results.append({"number": number, "area": one["area"], "file": one["file"], "kind": one["kind"],
                        "line": one["line"].strip(), "found_by": suite if test is not None else None, "test": test,
                        "seconds": round(time.monotonic() - begin, 1)})
        if form != "--json":
            print(f"{number:2} {one['area']:8} {one['file']}: {one['kind']}: {one['line'].strip()}\n"
                  f"   {'found by ' + suite + ': ' + test if test is not None else 'NOT FOUND'}", flush=True)
    found = sum(1 for result in results if result["test"] is not None)
    if form == "--json":
        print(json.dumps({"breaks": len(results), "found": found, "results": results}))
    else:
        print(f"{found} of {len(results)} found")
    return 0 if found == len(results) else 1


def main(arguments):
    command, *words = arguments
    if command == "draw":
        for one in draw(words[0], words[1]):
            print(json.dumps(one))
        return 0
    if command == "apply":
        apply(*words)
        return 0
    return run(words[0], words[1], words[2], words[3] if len(words) > 3 else "")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
