# SPDX-License-Identifier: MIT
"""Says which figures in the documents rest on sources that have changed since they were made (tests/bench/table_marks.py).

    python3 tests/stale_tables.py [--strict | --marks]

A mark that is not well formed is exit code 1. --marks: nothing but that is looked at, which needs no git. --strict, for a
release: figures that are stale, or of which nobody can tell, are exit code 1 too.
"""
import argparse
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "bench"))
import table_marks


def git(root, *words):
    return subprocess.run(["git", "-C", str(root), *words], capture_output=True, text=True, check=False)


def why_unknown(root, commit):
    """None where git knows the commit and HEAD comes after it."""
    if git(root, "rev-parse", "--verify", "-q", f"{commit}^{{commit}}").returncode == 0:
        after = git(root, "merge-base", "--is-ancestor", commit, "HEAD").returncode == 0
        return None if after else "the commit is not among those before this one"
    shallow = git(root, "rev-parse", "--is-shallow-repository")
    if shallow.returncode != 0:
        return "there is no git history here"
    return ("a shallow clone has no such commit: git fetch --unshallow" if shallow.stdout.strip() == "true"
            else "there is no such commit")


def state_of(root, mark):
    """(state, what is to be said): "as made", "stale" or "unknown"."""
    unknown = why_unknown(root, mark.commit)
    if unknown is not None:
        return "unknown", unknown
    paths = table_marks.watched_paths(mark)
    if git(root, "diff", "--quiet", mark.commit, "--", *paths).returncode == 0:
        return "as made", ""
    commits = git(root, "rev-list", "--count", f"{mark.commit}..HEAD", "--", *paths).stdout.strip()
    changed = git(root, "diff", "--name-only", mark.commit, "--", *paths).stdout.split("\n")[:-1]
    return "stale", f"{len(changed)} files of its sources have changed, {commits} commits"


def main(arguments, root):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--strict", action="store_true")
    parser.add_argument("--marks", action="store_true")
    options = parser.parse_args(arguments)
    try:
        marks = table_marks.all_marks(root)
    except table_marks.MarkError as error:
        print(error, file=sys.stderr)
        return 1
    if options.marks:
        print(f"{len(marks)} marks are well formed")
        return 0
    states = {mark.name: state_of(root, mark) for mark in marks}
    for mark in marks:
        state, why = states[mark.name]
        print(f"{state:8} {mark.name:22} {mark.commit[:12]:12}  {mark.place}{': ' if why else ''}{why}")
    stale = [mark for mark in marks if states[mark.name][0] != "as made"]
    print(f"{len(marks) - len(stale)} of {len(marks)} tables and figures are as their sources make them"
          + ("; bash tests/bench/all_tables.sh makes them anew" if stale else ""))
    return 1 if stale and options.strict else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:], pathlib.Path(__file__).resolve().parents[1]))
