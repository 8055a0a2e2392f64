# SPDX-License-Identifier: MIT
"""Wraps the documents at 100 columns: paragraphs and comments that have a longer line are filled anew, all else stays as
it is.

    python3 tests/wrap_documents.py [--check] [DOCUMENT.md...]

Left alone are tables, code, headings, HTML and what has no space to break at. --check writes nothing, and
names the documents that have such lines; exit code 1 then. Without documents: all of the project.
"""
import argparse
import pathlib
import re
import sys

COLUMNS = 100
COMMENT_INDENT = " " * len("<!-- ")
ITEM = re.compile(r"( *)([-*+]|\d+[.)])( +)(?=\S)")
FENCE = re.compile(r" *(`{3,}|~{3,})")
ALONE = re.compile(r" *(#{1,6} |\||<|\[[^\]]+\]: |(\* *){3,}$|(- *){3,}$|=+$)")  # lines that are no paragraph's
NOT_FIRST = re.compile(r"[-+*]|\d+[.)]|#{1,6}|[>|<=~].*|```.*|-{2,}|\[[^\]]+\]:")  # would be something else at a line's begin
PIECE = re.compile(r"(`+)[^`]+\1|\s+|[^\s`]+|`")  # code, space, or part of a word
SHORT_CODE = 60  # columns; longer code may be broken at its spaces


def words_of(text):
    """Parted at spaces, but not within short code, nor before what would be something else at a line's begin."""
    words = [""]
    for piece in (found.group() for found in PIECE.finditer(text)):
        if piece.isspace():
            words.append("")
        elif piece.startswith("`") and len(piece) <= SHORT_CODE:
            words[-1] += piece
        else:
            first, *others = re.split(r"\s+", piece)
            words[-1] += first
            words += others
    units = []
    for word in filter(None, words):
        if units and NOT_FIRST.fullmatch(word):
            units[-1] += " " + word
        else:
            units.append(word)
    return units


def fill(lines, first, others):
    """The words of the lines anew, the first line behind one prefix, the others behind another."""
    filled = [first]
    begun = False
    for word in words_of(" ".join(line.strip() for line in lines)):
        if begun and len(filled[-1]) + 1 + len(word) > COLUMNS:
            filled.append(others + word)
        else:
            filled[-1] += " " * begun + word
        begun = True
    return filled


def filled_where_long(lines, first, others):
    """A paragraph; its lines end where a hard break ends one."""
    bodies = [lines[0][len(first):], *lines[1:]]
    if others.startswith(">") or others.lstrip().startswith(">"):
        bodies[1:] = [re.sub(r"^ *> ?", "", line) for line in bodies[1:]]
    if all(len(line) <= COLUMNS for line in lines):
        return lines
    result, part = [], []
    for number, body in enumerate(bodies):
        part.append(body)
        hard = body.endswith("\\") or body.endswith("  ")
        if hard or number == len(bodies) - 1:
            result += fill(part, first if not result else others, others)
            if body.endswith("  "):
                result[-1] += "  "
            part = []
    return result


class Document:
    """Reads a document line by line into paragraphs and what is left alone."""

    def __init__(self, lines):
        self.lines, self.at, self.out, self.indent = lines, 0, [], 0  # indent: of the list item's text, 0 outside of lists

    def keep(self, count=1):
        self.out += self.lines[self.at:self.at + count]
        self.at += count

    def keep_to(self, ends):
        """This line and all up to the one that ends it."""
        last = self.at
        while last + 1 < len(self.lines) and not ends(self.lines[last]):
            last += 1
        self.keep(last + 1 - self.at)

    def keep_fence(self):
        fence = FENCE.match(self.lines[self.at]).group(1)
        self.keep()
        self.keep_to(lambda line: line.strip().startswith(fence))

    def comment(self):
        """A mark, or words that only the source shows; what stands behind its end on the last line stays there."""
        end = self.at + 1
        while end < len(self.lines) and "-->" not in self.lines[end - 1]:
            end += 1
        self.out += filled_where_long(self.lines[self.at:end], "", COMMENT_INDENT)
        self.at = end

    def starts_another(self, line, quoted):
        item = ITEM.match(line)
        begins = item is not None and (self.indent > 0 or item.group(2) in "-*+" or item.group(2)[:-1] == "1")
        return (not line.strip() or begins or bool(ALONE.match(line)) or bool(FENCE.match(line))
                or (line.lstrip().startswith(">") != quoted))

    def paragraph(self, first, others):
        quoted = self.lines[self.at].lstrip().startswith(">")
        end = self.at + 1
        while end < len(self.lines) and not self.starts_another(self.lines[end], quoted):
            end += 1
        self.out += filled_where_long(self.lines[self.at:end], first, others)
        self.at = end

    def wrapped(self):
        while self.at < len(self.lines):
            line = self.lines[self.at]
            spaces = len(line) - len(line.lstrip())
            item = ITEM.match(line)
            if not line.strip():
                self.keep()
            elif FENCE.match(line):
                self.keep_fence()
            elif line.lstrip().startswith("<!--"):
                self.comment()
            elif spaces >= self.indent + 4:
                self.keep()
            elif item:
                self.indent = len(item.group())
                self.paragraph(item.group(), " " * self.indent)
            elif ALONE.match(line):
                self.keep()
            else:
                if spaces < self.indent:
                    self.indent = 0
                begin = re.match(r" *(> ?)*", line).group()
                self.paragraph(begin, begin)
        return self.out


def wrapped(text):
    return "\n".join(Document(text.split("\n")).wrapped())


def documents(root):
    return [root / "README.md", root / "recordings/README.md",
            *(path for folder in ("docs", "protocols", "firmware_servo") for path in sorted((root / folder).glob("**/*.md")))]


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("documents", nargs="*", type=pathlib.Path)
    options = parser.parse_args(arguments)
    root = pathlib.Path(__file__).resolve().parents[1]
    good = True
    for path in options.documents or documents(root):
        text = path.read_text(encoding="utf-8")
        anew = wrapped(text)
        if anew == text:
            continue
        good = False
        if options.check:
            print(f"{path}: lines are longer than {COLUMNS} columns; python3 tests/wrap_documents.py mends it", file=sys.stderr)
        else:
            path.write_text(anew, encoding="utf-8")
    return 0 if good or not options.check else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
