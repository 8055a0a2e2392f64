# SPDX-License-Identifier: MIT
"""Worlds that do the program no favours, one effect at a time and all at once: what its labels and times are worth
there, and whether it says so. Called by hard_table.sh, which says how; docs/evidence/hard_table.md says what it measures."""
import argparse
import concurrent.futures
import json
import os
import re
import subprocess
import sys
import time

import hard_figures
import hard_rows

SEEDS = 5
LONGEST_S = 3600  # of one session: the machine may be busy


def arguments_of(words):
    parser = argparse.ArgumentParser(prog="hard_table.sh")
    parser.add_argument("program", help=argparse.SUPPRESS)
    parser.add_argument("--json", action="store_true", help="one snake_case key a figure")
    parser.add_argument("--quick", action="store_true", help="one seed a row")
    parser.add_argument("--first-seed", type=int, default=6001, metavar="N", help="seeds from N on (default 6001)")
    parser.add_argument("--only", metavar="KNOB-OR-GLOB", help="some rows: gyro.scale_change, 'camera.*', typical")
    parser.add_argument("--typical-seeds", type=int, metavar="N", help="of the row typical (default 100; --quick: 1)")
    parser.add_argument("--honest-seeds", type=int, metavar="N", help="of the row honest (default 100; --quick: 1)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N", help="sessions at a time")
    parser.add_argument("--sessions", metavar="FILE", help="what each session stated and said: a JSON object a line")
    return parser.parse_args(words)


def rows_of(options):
    printed = subprocess.run([options.program, "--knobs"], check=True, capture_output=True, text=True).stdout
    many = 1 if options.quick else 100
    rows = hard_rows.all_rows(json.loads(printed), 1 if options.quick else SEEDS,
                              options.honest_seeds or many, options.typical_seeds or many)
    if options.only:
        rows = hard_rows.chosen(rows, options.only)
    if not rows:
        sys.exit(f"no row is called {options.only}")
    return rows


def run_case(program, row, seed, environment):
    words = [program, str(seed), environment, row.world]
    if row.calibrated_in:
        words.append(row.calibrated_in)
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=LONGEST_S)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(words)}: exit code {done.returncode}\n{done.stderr}")
    return json.loads(done.stdout)


def keep(file, row, case):
    """Everything but the long lists."""
    short = {key: value for key, value in case.items() if key not in ("labels", "times")}
    short |= {"row": row.name, "letter": hard_figures.letter_of(case)}
    if not case["refusal"]:
        one = hard_figures.figures_of([case])
        short |= {"label_rms_dps": one.label_rms_dps, "beyond_share": one.beyond_share, "sigma_dps": one.sigma_dps,
                  "commanded_rms_dps": one.commanded_rms_dps, "rejected_share": one.rejected_share,
                  "useless_share": one.useless_share, "needless_share": one.needless_share,
                  "p99_ms": one.p99_ms, "outside": one.outside,
                  "mean_ms": {device: case["times"][device]["mean_ms"] for device in hard_figures.DEVICES}}
    file.write(json.dumps(short) + "\n")
    file.flush()


class Progress:
    """What is done, on the terminal: each row, and of a row of many sessions every tenth."""
    def __init__(self, rows):
        self.begin, self.rows, self.done = time.monotonic(), rows, 0

    def say(self, words):
        print(f"{time.monotonic() - self.begin:6.0f} s  {words}", file=sys.stderr, flush=True)

    def session(self, row, count):
        if count % 10 == 0 and count < row.seeds:
            self.say(f"{row.name}: {count} of {row.seeds} sessions")

    def row(self, row, letter):
        self.done += 1
        self.say(f"{self.done:3} of {self.rows} rows  {letter:2}  {row.name}")


def cases_of(row, futures, progress, file):
    cases = []
    for future in futures:
        cases.append(future.result())
        if file:
            keep(file, row, cases[-1])
        progress.session(row, len(cases))
    return cases


def measure(options, rows):
    """RowFigures by the row's name, in order. A row's sessions are let go as soon as it is complete."""
    figures, progress = {}, Progress(len(rows))
    file = open(options.sessions, "w", encoding="utf-8") if options.sessions else None
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        waiting = [(row, [pool.submit(run_case, options.program, row, options.first_seed + index,
                                      row.environment(index)) for index in range(row.seeds)]) for row in rows]
        try:
            while waiting:
                row, futures = waiting.pop(0)
                cases = cases_of(row, futures, progress, file)
                futures.clear()
                figures[row.name] = hard_figures.figures_of(cases)
                progress.row(row, figures[row.name].letter())
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    if file:
        file.close()
    return figures


def text(value, digits=2):
    return "-" if value is None else f"{value:.{digits}f}"


def percent_text(part):
    return text(hard_figures.percent(part), 1)


def letters_text(letters):
    return ", ".join(f"{letter} {letters[letter]}" for letter in hard_figures.LETTERS if letters[letter])


def print_table(figures, limits, head):
    print(head + "\n")
    print("| world | | label RMS, deg/s | beyond 3 sigma, % | sigma, deg/s | commanded RMS, deg/s | rejected, % "
          "| camera p99, ms / outside, % | gyro | servo | verdict |")
    print("| --- |" + " --- |" * 10)
    for name, row in figures.items():
        times = [f"{text(row.p99_ms[device])} / {percent_text(row.outside[device])}" for device in hard_figures.DEVICES]
        letter = f"**{row.letter()}**" if row.letter() == "c" else row.letter()
        if len(row.letters) > 1:
            letter += f" ({letters_text(row.letters)})"
        print(f"| {name} | {letter} | {text(row.label_rms_dps)} | {percent_text(row.beyond_share)} | "
              f"{text(row.sigma_dps)} | {text(row.commanded_rms_dps)} | {percent_text(row.rejected_share)} | "
              f"{' | '.join(times)} | {row.words} |")
    print()
    for limit in limits:
        bound = f"<= {limit.at_most:g}" if limit.at_most is not None else f">= {limit.at_least:g}"
        value = "-" if limit.value is None else f"{limit.value:.3g}"
        print(f"* {limit.verdict()}: {limit.text}: {value} {limit.unit} ({bound})".replace("  (", " ("))


def snake_case(name):
    """A row's name as part of a key. What is below 0 and what is above are two rows."""
    return re.sub(r"[^a-z0-9]+", "_", name.lower().replace("=-", "=minus ").replace(".", "_")).strip("_")


def values_of(row):
    """(key, unit, value) of a row."""
    yield from ((f"{key}_sessions", "", row.letters[letter])
                for key, letter in zip(("right", "told_with_cause", "told_without_cause", "silently_wrong"),
                                       hard_figures.LETTERS, strict=True))
    yield from ((f"verdict_{verdict}_sessions", "", row.verdicts[verdict])
                for verdict in ("good", "usable", "bad", "refused"))
    yield "label_rms_dps", "deg/s", row.label_rms_dps
    yield "beyond_three_sigma_percent", "%", hard_figures.percent(row.beyond_share)
    yield "sigma_dps", "deg/s", row.sigma_dps
    yield "commanded_rms_dps", "deg/s", row.commanded_rms_dps
    yield "rejected_percent", "%", hard_figures.percent(row.rejected_share)
    yield "useless_percent", "%", hard_figures.percent(row.useless_share)
    yield "needlessly_rejected_percent", "%", hard_figures.percent(row.needless_share)
    for device in hard_figures.DEVICES:
        yield f"{device}_p99_ms", "ms", row.p99_ms[device]
        yield f"{device}_outside_percent", "%", hard_figures.percent(row.outside[device])


def json_of(figures, limits):
    object_of = {}

    def add(key, value, unit, at_most=None, at_least=None, met=None):
        object_of[key] = {"value": value, "unit": unit, "at_most": at_most, "at_least": at_least, "met": met}

    for name, row in figures.items():
        for key, unit, value in values_of(row):
            add(f"{snake_case(name)}_{key}", value, unit)
    for limit in limits:
        met = None if limit.verdict() == "not measured" else limit.verdict() == "PASS"
        add(f"limit_{limit.key}", limit.value, limit.unit, limit.at_most, limit.at_least, met)
    return object_of


def main(words):
    options = arguments_of(words)
    rows = rows_of(options)
    begin = time.monotonic()
    figures = measure(options, rows)
    limits = hard_figures.limits_of(figures)
    sessions = sum(row.sessions for row in figures.values())
    if options.json:
        print(json.dumps(json_of(figures, limits), indent=1))
    else:
        print_table(figures, limits, f"Simulated rigs in virtual time: {sessions} sessions of the plan paper, from seed "
                                     f"{options.first_seed} on; made in {time.monotonic() - begin:.0f} s.")
    return 1 if any(limit.verdict() == "MISS" for limit in limits) else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except (RuntimeError, subprocess.SubprocessError) as error:
        sys.exit(f"hard_table: {error}")
