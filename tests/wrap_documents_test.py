# SPDX-License-Identifier: MIT
"""What is wrapped, what is left alone, and that no document becomes another one.

    python3 tests/wrap_documents_test.py
"""
import pathlib
import unittest

from wrap_documents import COLUMNS, documents, wrapped

LONG = "A sentence of ten words that goes on for too long. " * 4
ROOT = pathlib.Path(__file__).resolve().parents[1]


class WrappedDocuments(unittest.TestCase):
    def expect_filled(self, text, *begins):
        """Each line at most as long as allowed, behind what it must begin with; the words are as before."""
        lines = wrapped(text).split("\n")
        self.assertEqual(" ".join(lines).split(), [*" ".join(text.split("\n")).split()])
        self.assertTrue(all(len(line) <= COLUMNS for line in lines))
        for begin, line in zip(begins, lines):
            self.assertTrue(line.startswith(begin) and line[len(begin)] != " ", line)

    def expect_alone(self, text):
        self.assertEqual(wrapped(text), text)

    def test_a_long_paragraph_is_filled(self):
        self.expect_filled(LONG, "", "", "")

    def test_lines_of_an_item_stand_below_its_text(self):
        self.expect_filled("- " + LONG, "- ", "  ", "  ")
        self.expect_filled("1. one\n2. " + LONG, "1. ", "2. ", "   ", "   ")
        self.expect_filled("* one\n  - " + LONG, "* ", "  - ", "    ", "    ")

    def test_a_second_paragraph_of_an_item_keeps_its_place(self):
        self.expect_filled("- one\n\n  " + LONG, "- ")
        self.assertEqual([line[:2] for line in wrapped("- one\n\n  " + LONG).split("\n")][2:], ["  ", "  ", "  "])

    def test_a_quote_stays_one(self):
        self.assertTrue(all(line.startswith("> ") for line in wrapped("> " + LONG).split("\n")))
        self.assertNotIn("> ", wrapped("> " + LONG + "\n> " + LONG)[2:].replace("\n> ", ""))

    def test_a_comment_is_filled_behind_its_begin(self):
        self.expect_filled("<!-- " + LONG + "\n" + LONG + " -->", "<!-- ", "     ", "     ")
        self.expect_alone("<!-- Short\nlines. -->\n# " + LONG)

    def test_a_paragraph_without_a_long_line_stays_as_it_is(self):
        self.expect_alone("Short\nlines\nof somebody.")

    def test_what_is_no_prose_is_left_alone(self):
        for text in ("| " + LONG + "|\n| --- |\n| " + LONG + "|", "```\n" + LONG + "\n\n" + LONG + "\n```", "    " + LONG,
                     "# " + LONG, "[link]: https://" + 200 * "x", 200 * "x"):
            with self.subTest(text[:8]):
                self.expect_alone(text)

    def test_no_line_begins_with_what_would_be_something_else_there(self):
        for word in ("-", "+", "1.", "2)", "#", "|", ">"):
            for length in range(70, 101):
                text = "x" * length + f" {word} " + LONG
                with self.subTest(text[length:length + 4]):
                    self.assertFalse(any(line.startswith(word + " ") for line in wrapped(text).split("\n")))

    def test_short_code_keeps_its_spaces(self):
        for length in range(60, 101):
            self.assertIn("`git log --oneline`", wrapped("x" * length + " `git log --oneline` " + LONG))

    def test_a_hard_break_stays(self):
        self.assertIn("end.  \nNext", wrapped(LONG + "end.  \nNext " + LONG))

    def test_of_the_documents_nothing_is_left_to_wrap_after_once(self):
        for path in documents(ROOT):
            once = wrapped(path.read_text(encoding="utf-8"))
            self.assertEqual(wrapped(once), once, path)


if __name__ == "__main__":
    unittest.main()
