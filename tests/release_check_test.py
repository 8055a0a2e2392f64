# SPDX-License-Identifier: MIT
"""What release_check.sh lets pass, and what not: on a small project of its own, with git.

    python3 tests/release_check_test.py
"""
import shutil
import tempfile
import unittest

from stale_tables_test import TESTS, Project, run

PLACE = "# Reliability\n\n<!-- last full pass: here -->\nNone yet.\n\nMore.\n"


class ReleaseCheck(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.project = Project(folder.name)
        for name in ("release_check.sh", "last_pass.sh"):
            shutil.copy(TESTS / name, self.project.folder / "tests" / name)
        self.project.write("CMakeLists.txt", "project(thermorig VERSION 1.2.0 LANGUAGES C CXX)\n")
        self.project.write("CITATION.cff", 'version: 1.2.0\ndate-released: "2027-01-31"\n')
        self.project.write("docs/CHANGELOG.md", "# Change log\n\n## 1.2.0 (2027-01-31)\n")
        self.project.write("docs/reliability.md", PLACE)
        commit = self.project.commit("a release")
        self.passes(commit)
        self.project.commit("its full pass")

    def passes(self, commit):
        done = run(self.project.folder, "bash", "-c", f"source tests/last_pass.sh; write_last_pass {commit} 2027-01-30")
        self.assertEqual(done.returncode, 0, done.stderr)

    def expect_refused(self, said):
        done = run(self.project.folder, "bash", "tests/release_check.sh")
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn(said, done.stderr)

    def change(self, path, text):
        self.project.write(path, text)
        self.project.commit(f"changes {path}")

    def test_what_is_as_it_must_be_passes(self):
        self.change("docs/more.md", "A document may come after the pass.\n")
        done = run(self.project.folder, "bash", "tests/release_check.sh")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("version 1.2.0 is fit to be tagged", done.stdout)

    def test_a_change_without_a_commit_is_refused(self):
        self.project.write("src/clock/error", "0.7\n")
        self.expect_refused("changes that no commit has")

    def test_versions_that_differ_are_refused(self):
        self.change("CITATION.cff", 'version: 1.1.0\ndate-released: "2027-01-31"\n')
        self.expect_refused("CITATION.cff has version 1.1.0")

    def test_a_change_log_without_a_date_is_refused(self):
        self.change("docs/CHANGELOG.md", "# Change log\n\n## 1.2.0 (unreleased)\n")
        self.expect_refused("first heading has no date")

    def test_dates_that_differ_are_refused(self):
        self.change("docs/CHANGELOG.md", "# Change log\n\n## 1.2.0 (2027-02-01)\n")
        self.expect_refused("released on 2027-01-31, by the change log on 2027-02-01")

    def test_a_tag_of_another_commit_is_refused(self):
        self.project.git("tag", "v1.2.0", "HEAD~1")
        self.expect_refused("the tag v1.2.0 is of another commit")

    def test_a_program_that_changed_since_the_last_full_pass_is_refused(self):
        self.change("src/other/colour", "blue\n")
        self.expect_refused("there have changed:\nsrc/other/colour")

    def test_without_a_full_pass_it_is_refused(self):
        self.change("tests/last_passes.txt", "")
        self.expect_refused("no full pass of tests/nightly.sh is written down")

    def test_stale_figures_are_refused(self):
        self.change("src/clock/error", "0.7\n")
        self.passes(self.project.git("rev-parse", "HEAD"))
        self.project.commit("a pass")
        self.expect_refused("figures that are stale")

    def test_a_full_pass_stands_in_the_document_below_its_mark(self):
        commit = self.project.git("rev-parse", "HEAD~1")
        self.assertEqual(self.project.read("docs/reliability.md"), PLACE.replace(
            "None yet.", f"The last full pass of `bash tests/nightly.sh` was at commit `{commit[:12]}`, on 2027-01-30."))
        self.assertIn("\nusb_guest ", self.project.read("tests/last_passes.txt"))


if __name__ == "__main__":
    unittest.main()
