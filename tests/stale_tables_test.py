# SPDX-License-Identifier: MIT
"""Figures that rest on changed sources are seen, and made anew: on a small project of its own, with git.

    python3 tests/stale_tables_test.py
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

TESTS = pathlib.Path(__file__).resolve().parent
TABLE = "| speed | error |\n| --- | ---: |\n| 20 | 0.5 |\n"
SCRIPT = "# prints how long a metre is\nprintf '| speed | error |\\n| --- | ---: |\\n| 20 | %s |\\n' \"$(cat src/clock/error)\"\n"


def run(folder, *words):
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)


class Project:
    """A project with one source, one script that makes a table of it, and one document."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.git("init", "-q", "-b", "main")
        for name in ("stale_tables.py", "wrap_documents.py", "bench/table_marks.py", "bench/table_layouts.py", "bench/all_tables.py",
                     "bench/all_tables.sh"):
            (self.folder / "tests" / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(TESTS / name, self.folder / "tests" / name)
        self.write("src/clock/error", "0.5\n")
        self.write("src/other/colour", "red\n")
        self.write("tests/bench/speeds.sh", SCRIPT)
        self.write(".gitignore", "build\n__pycache__\n")
        self.write("README.md", "# A project\n")
        self.first = self.commit("all of it")
        self.document(self.mark(), TABLE)

    def git(self, *words):
        done = run(self.folder, "git", "-c", "user.name=nobody", "-c", "user.email=nobody@localhost", *words)
        if done.returncode != 0:
            raise RuntimeError(done.stderr)
        return done.stdout.strip()

    def write(self, path, text):
        (self.folder / path).parent.mkdir(parents=True, exist_ok=True)
        (self.folder / path).write_text(text)

    def read(self, path):
        return (self.folder / path).read_text()

    def commit(self, subject):
        self.git("add", "-A")
        self.git("commit", "-q", "-m", subject)
        return self.git("rev-parse", "--short=12", "HEAD")

    def mark(self, commit=None, sources="clock", script="tests/bench/speeds.sh"):
        return f"<!-- table speeds: {script}; commit {commit or self.first};\n     sources: {sources} -->"

    def document(self, begin, table, end="<!-- end of table speeds -->"):
        self.write("docs/speeds.md", f"# Speeds\n\n{begin}\n\n{table}\n{end}\n\nMore.\n")
        self.commit("the document")

    def stale(self, *words):
        return run(self.folder, sys.executable, "tests/stale_tables.py", *words)

    def all_tables(self, *words):
        return run(self.folder, "bash", "tests/bench/all_tables.sh", *words)


class StaleTables(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.project = Project(folder.name)

    def expect(self, code, said, *words):
        done = self.project.stale(*words)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertIn(said, done.stdout + done.stderr)

    def test_a_table_whose_sources_are_as_they_were_is_as_made(self):
        self.project.write("src/other/colour", "blue\n")
        self.project.commit("what the table does not rest on")
        self.expect(0, "as made  speeds", "--strict")

    def test_a_changed_source_makes_it_stale(self):
        self.project.write("src/clock/error", "0.7\n")
        self.project.commit("a clock that is worse")
        self.expect(0, "stale    speeds")
        self.expect(0, "1 files of its sources have changed, 1 commits")
        self.expect(1, "0 of 1 tables", "--strict")

    def test_a_change_without_a_commit_makes_it_stale_as_well(self):
        self.project.write("src/clock/error", "0.7\n")
        self.expect(1, "1 files of its sources have changed, 0 commits", "--strict")

    def test_the_script_is_a_source_too(self):
        self.project.write("tests/bench/speeds.sh", SCRIPT + "# more\n")
        self.project.commit("a script that prints more")
        self.expect(1, "stale    speeds", "--strict")

    def test_of_a_commit_that_is_not_there_nobody_can_tell(self):
        self.project.document(self.project.mark(commit="0123456789ab"), TABLE)
        self.expect(0, "unknown  speeds")
        self.expect(1, "there is no such commit", "--strict")

    def test_of_a_commit_beside_this_one_nobody_can_tell(self):
        self.project.git("checkout", "-q", "-b", "side")
        self.project.write("src/other/colour", "green\n")
        beside = self.project.commit("beside")
        self.project.git("checkout", "-q", "main")
        self.project.document(self.project.mark(commit=beside), TABLE)
        self.expect(1, "not among those before this one", "--strict")

    def test_a_shallow_clone_says_that_it_is_one(self):
        with tempfile.TemporaryDirectory() as folder:
            run(folder, "git", "clone", "-q", "--depth", "1", f"file://{self.project.folder}", "clone")
            done = run(f"{folder}/clone", sys.executable, "tests/stale_tables.py")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("a shallow clone has no such commit", done.stdout)

    def test_without_git_the_marks_are_checked_all_the_same(self):
        shutil.rmtree(self.project.folder / ".git")
        self.expect(0, "1 marks are well formed", "--marks")
        self.expect(0, "there is no git history here")

    def test_marks_that_are_not_well_formed_always_fail(self):
        mark = self.project.mark()
        for begin, end, said in [
                (mark.replace("; commit", ", commit"), "<!-- end of table speeds -->", "docs/speeds.md:3: no mark as"),
                (mark, "", "the table speeds has no end"),
                (mark, "<!-- end of table other -->", "docs/speeds.md:10: a table other ends that has not begun"),
                (mark + mark, "<!-- end of table speeds -->", "speeds begins before the table speeds has ended"),
                (self.project.mark(script="tests/bench/none.sh"), "<!-- end of table speeds -->", "there is no script"),
                (self.project.mark(sources="clock none"), "<!-- end of table speeds -->", "there is no source none"),
                (self.project.mark(sources="docs/speeds.md"), "<!-- end of table speeds -->", "figures rest on no document"),
                ("", "", "docs/speeds.md:5: a table of figures without a mark")]:
            with self.subTest(said):
                self.project.document(begin, TABLE, end)
                self.expect(1, said)
                self.expect(1, said, "--marks")

    def test_a_table_of_words_needs_no_mark(self):
        self.project.document("", "| code | meaning |\n| --- | --- |\n| 1.5 | one and a half |\n", "")
        self.expect(0, "0 marks are well formed", "--marks")

    def test_making_all_anew_replaces_the_table_and_its_commit(self):
        self.project.write("src/clock/error", "0.7\n")
        commit = self.project.commit("a clock that is worse")
        done = self.project.all_tables()
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(self.project.read("docs/speeds.md"),
                         f"# Speeds\n\n{self.project.mark(commit=commit)}\n\n{TABLE.replace('0.5', '0.7')}\n"
                         "<!-- end of table speeds -->\n\nMore.\n")
        self.expect(0, "1 of 1 tables", "--strict")

    def test_a_script_that_fails_leaves_its_table(self):
        for script in ("exit 3\n", "exit 1\n", "echo nothing\n", "printf '| a |\\n| --- |\\n'\n"):
            with self.subTest(script):
                self.project.write("tests/bench/speeds.sh", script)
                self.project.commit("a script that fails")
                before = self.project.read("docs/speeds.md")
                done = self.project.all_tables("speeds")
                self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
                self.assertIn("left as it was", done.stdout)
                self.assertEqual(self.project.read("docs/speeds.md"), before)

    def test_what_a_sentence_rests_on_is_kept_for_who_writes_it(self):
        begin = self.project.mark().replace("table", "figures")
        self.project.document(begin, "The error is 0.5.", "")
        before = self.project.read("docs/speeds.md")
        done = self.project.all_tables()
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("correct what stands below the mark", done.stdout)
        self.assertIn(TABLE, self.project.read("build/tables/speeds.txt"))
        self.assertEqual(self.project.read("docs/speeds.md"), before)

    def test_what_trains_is_made_with_train_alone_and_before_tables(self):
        self.project.write("tests/bench/train.sh", "echo 0.9 >build/trained\n")
        self.project.write("tests/bench/speeds.sh", SCRIPT.replace("src/clock/error", "build/trained"))
        self.project.write("build/trained", "0.4\n")
        self.project.commit("a table of what is trained")
        trained = self.project.mark().replace("table speeds", "files trained").replace("speeds.sh", "train.sh; with --train")
        self.project.document(self.project.mark(), TABLE, f"<!-- end of table speeds -->\n\n{trained}")
        commit = self.project.git("rev-parse", "--short=12", "HEAD")
        self.project.write("build/paper-study/raw/old.h5", "of an older program")
        self.project.all_tables()
        self.assertIn("| 20 | 0.4 |", self.project.read("docs/speeds.md"))
        done = self.project.all_tables("--train")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("| 20 | 0.9 |", self.project.read("docs/speeds.md"))
        self.assertEqual(self.project.read("docs/speeds.md").count(f"commit {commit}"), 2)
        self.assertFalse((self.project.folder / "build/paper-study/raw").exists())

    def test_tables_are_not_made_of_what_no_commit_has(self):
        self.project.write("src/clock/error", "0.7\n")
        done = self.project.all_tables()
        self.assertEqual(done.returncode, 1)
        self.assertIn("not every change is in a commit", done.stderr)


if __name__ == "__main__":
    unittest.main()
