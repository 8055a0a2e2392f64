# SPDX-License-Identifier: MIT
"""Makes the figures in the documents anew. Called by all_tables.sh, which says how."""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys
import time

import table_marks
from table_layouts import LAYOUTS, OF_TEXT

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from wrap_documents import wrapped
OUTPUTS = ROOT / "build/tables"
RECORDINGS = [ROOT / "build/paper-study" / gyro for gyro in ("raw", "calibrated")]  # and what was trained on them


def commit_now():
    """The commit that figures made now are of. Exits where there is none: something differs from it."""
    changes = subprocess.run(["git", "status", "--porcelain", "--untracked-files=no", "--", ".", ":!docs", ":!*.md"],
                             cwd=ROOT, check=True, capture_output=True, text=True).stdout
    if changes:
        sys.exit(f"not every change is in a commit, so no table could name one:\n{changes}")
    return subprocess.run(["git", "rev-parse", "--short=12", "HEAD"], cwd=ROOT, check=True, capture_output=True,
                          text=True).stdout.strip()


def command_of(mark):
    as_json = mark.name in LAYOUTS and mark.name not in OF_TEXT
    return ("bash", *mark.command, *(["--json"] if as_json else []))


def run(command, outputs):
    """(what it printed, exit code), run once for all marks that share the command. Errors go to the terminal."""
    if command not in outputs:
        print(f"== {' '.join(command)}", flush=True)
        begin = time.monotonic()
        done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False)
        print(f"== took {time.monotonic() - begin:.0f} s, exit code {done.returncode}", flush=True)
        outputs[command] = done.stdout, done.returncode
    return outputs[command]


def body_of(mark, printed):
    """The Markdown of a table. Throws ValueError or KeyError where the script printed something else."""
    if mark.name in LAYOUTS:
        body = LAYOUTS[mark.name](printed if mark.name in OF_TEXT else json.loads(printed))
    else:
        body = printed
    if "\n| ---" not in body or body.rstrip().endswith("---: |") or body.rstrip().endswith("--- |"):
        raise ValueError("it printed no table")
    return wrapped(body)


def make(mark, commit, outputs):
    """What became of it: (good, a sentence). A script ends with 1 also where a figure does not meet what it must: the
    table then says so, and is as good as any."""
    printed, code = run(command_of(mark), outputs)
    OUTPUTS.mkdir(parents=True, exist_ok=True)
    kept = OUTPUTS / f"{mark.name}.txt"
    kept.write_text(f"{' '.join(command_of(mark))}\ncommit {commit}, exit code {code}\n\n{printed}", encoding="utf-8")
    remark = f", exit code {code}: a figure is not what it must be" if code == 1 else ""
    if mark.kind == "figures":
        return code == 0, (f"see {kept.relative_to(ROOT)}{remark}; correct what stands below the mark, and its commit: "
                           f"{commit}")
    if mark.kind == "files":
        if code != 0:
            return False, f"exit code {code}"
        table_marks.write_anew(ROOT, mark.name, None, commit)
        return True, "its files are written"
    if code not in (0, 1):
        return False, f"left as it was, exit code {code}"
    try:
        body = body_of(mark, printed)
    except (ValueError, KeyError) as error:
        return False, f"left as it was: {error!r}; see {kept.relative_to(ROOT)}"
    table_marks.write_anew(ROOT, mark.name, body, commit)
    return True, f"written{remark}"


def chosen(marks, options):
    """What is to be made, files first: tables are made of them."""
    unknown = set(options.names) - {mark.name for mark in marks}
    if unknown:
        sys.exit(f"no mark has the name {', '.join(sorted(unknown))}; --list says which there are")
    if options.names:
        marks = [mark for mark in marks if mark.name in options.names]
    elif not options.train:
        marks = [mark for mark in marks if not mark.train]
    return sorted(marks, key=lambda mark: mark.kind != "files")


def main(arguments):
    parser = argparse.ArgumentParser(prog="all_tables.sh")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--train", action="store_true")
    parser.add_argument("names", nargs="*")
    options = parser.parse_args(arguments)
    marks = table_marks.all_marks(ROOT)
    if options.list:
        for mark in marks:
            print(f"{mark.kind:8} {mark.name:20} {' '.join(mark.command)}{' (with --train)' if mark.train else ''}")
        return 0
    commit, outputs, good = commit_now(), {}, True
    marks = chosen(marks, options)
    if any(mark.train for mark in marks):
        for folder in RECORDINGS:  # else older ones than the commit would be taken
            shutil.rmtree(folder, ignore_errors=True)
    for mark in marks:
        well, said = make(mark, commit, outputs)
        good = good and well
        print(f"{mark.document}: {mark.name}: {said}", flush=True)
    return 0 if good else 1


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except table_marks.MarkError as error:
        sys.exit(str(error))
