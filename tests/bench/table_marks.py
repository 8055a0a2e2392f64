# SPDX-License-Identifier: MIT
"""The marks that measured figures carry in the documents: how they were made, at which commit, and what they rest on.

    <!-- table NAME: SCRIPT [WORD...]; commit COMMIT; sources: SOURCE... -->
    the table and what else the script prints
    <!-- end of table NAME -->

`table`: all between the two lines is what the script prints. `figures`: sentences that somebody wrote from what it prints;
`files`: files that it writes. These two have no end. "; with --train" before the commit: it trains networks, which takes
hours. A source is a module or a room by its folder's name (src/NAME or src/ROOM/NAME, and the same in include), a path, or
a pattern of paths; the script is always one. A mark may go over several lines.
"""
import dataclasses
import pathlib
import re

KINDS = ("table", "figures", "files")
COMMENT = re.compile(r"<!--(.*?)-->", re.DOTALL)
BEGIN = re.compile(r"(?P<kind>table|figures|files) (?P<name>[a-z0-9_]+): (?P<command>[\w./=*, -]+)(?P<train>; with --train)?"
                   r"; commit (?P<commit>[0-9a-f]{7,40}); sources: (?P<sources>[\w./* -]+)")
NUMBER = r"[<>=+-]* ?\d[\d.,e-]*(?: [\w%/]{1,5})?"  # with its unit
NUMBERS = re.compile(rf"{NUMBER}(?:(?:,| /| ->| \.\.) {NUMBER})*(?: \(.*\))?")
END = re.compile(r"end of table (?P<name>[a-z0-9_]+)")


class MarkError(Exception):
    """A mark that is not well formed: "document:line: what is wrong"."""


@dataclasses.dataclass(frozen=True)
class Mark:
    kind: str
    name: str
    command: tuple  # script and words, without the shell
    train: bool
    commit: str
    sources: tuple  # as written
    document: str  # relative to the project
    line: int  # from 1
    comment: tuple  # begin and end of the comment in the document's text
    end: int = 0  # of a table: where the line that ends it begins

    @property
    def place(self):
        return f"{self.document}:{self.line}"


def documents(root):
    """README.md and all of docs."""
    return [root / "README.md", *sorted((root / "docs").glob("**/*.md"))]


def paths_of(source):
    """What git is asked for: a module's two folders, of a room or in one; else the source itself."""
    if "/" in source or "." in source:
        return (source,)
    return tuple(f"{root}/{place}" for root in ("src", "include/thermorig") for place in (source, f"*/{source}/*"))


def watched_paths(mark):
    """All paths that the figures rest on, the script among them."""
    return [mark.command[0]] + [path for source in mark.sources for path in paths_of(source)]


def marks_of(text, document):
    """The marks of a document in order. Throws MarkError."""
    marks, opened = [], None
    for comment in COMMENT.finditer(text):
        words = " ".join(comment.group(1).split())
        place = f"{document}:{text.count(chr(10), 0, comment.start()) + 1}"
        if END.fullmatch(words):
            name = END.fullmatch(words)["name"]
            if opened is None or opened.name != name:
                raise MarkError(f"{place}: a table {name} ends that has not begun")
            marks.append(dataclasses.replace(opened, end=comment.start()))
            opened = None
        elif re.match(rf"({'|'.join(KINDS)})\b|end of\b", words):
            begin = BEGIN.fullmatch(words)
            if begin is None:
                raise MarkError(f"{place}: no mark as tests/bench/table_marks.py describes it: {words[:60]}")
            if opened is not None:
                raise MarkError(f"{place}: {begin['name']} begins before the table {opened.name} has ended")
            mark = Mark(begin["kind"], begin["name"], tuple(begin["command"].split()), begin["train"] is not None,
                        begin["commit"], tuple(begin["sources"].split()), document, int(place.rsplit(":", 1)[1]),
                        comment.span())
            if mark.kind == "table":
                opened = mark
            else:
                marks.append(mark)
    if opened is not None:
        raise MarkError(f"{opened.place}: the table {opened.name} has no end")
    return marks


def rows_of(text):
    """The tables of a document: (where it begins, its cells but for the head's and the first column's)."""
    for table in re.finditer(r"(?:^\|.*\|\n)+", text, re.MULTILINE):
        rows = [re.split(r"(?<!\\)\|", row)[2:-1] for row in table.group().splitlines()[2:]]
        yield table.start(), [cell.strip(" *") for row in rows for cell in row if cell.strip()]


def check_no_figures_without(marks, text, document):
    """A table of which more than half of the cells are numbers, one of them with a fraction or thousands, was measured: it
    must stand within a mark. Throws MarkError."""
    for begin, cells in rows_of(text):
        numbers = [cell for cell in cells if NUMBERS.fullmatch(cell)]
        measured = 2 * len(numbers) > len(cells) and any(re.search(r"\d[.,]\d", number) for number in numbers)
        if measured and not any(mark.kind == "table" and mark.comment[1] <= begin < mark.end for mark in marks):
            line = text.count("\n", 0, begin) + 1
            raise MarkError(f"{document}:{line}: a table of figures without a mark (tests/bench/table_marks.py): "
                            "which script makes it, and at which commit?")


def check_paths(mark, root):
    """Throws MarkError where script or sources are not there."""
    if not (root / mark.command[0]).is_file():
        raise MarkError(f"{mark.place}: there is no script {mark.command[0]}")
    for source in mark.sources:
        if source.startswith("docs"):
            raise MarkError(f"{mark.place}: {source}: figures rest on no document")
        if not any(any(root.glob(path)) for path in paths_of(source)):
            raise MarkError(f"{mark.place}: there is no source {source}")


def all_marks(root):
    """Of all documents, checked. Throws MarkError."""
    marks, places = [], {}
    for path in documents(root):
        text, document = path.read_text(encoding="utf-8"), str(path.relative_to(root))
        found = marks_of(text, document)
        check_no_figures_without(found, text, document)
        for mark in found:
            check_paths(mark, root)
            if mark.name in places:
                raise MarkError(f"{mark.place}: {mark.name} stands at {places[mark.name]} already")
            places[mark.name] = mark.place
            marks.append(mark)
    return marks


def made_anew(text, mark, body, commit):
    """The document's text with the mark at another commit, and, of a table, with another body."""
    begin, end = mark.comment
    comment = re.sub(rf"(;\s+commit\s+){mark.commit}", rf"\g<1>{commit}", text[begin:end])
    rest = text[end:] if mark.kind != "table" else f"\n\n{body.strip()}\n\n" + text[mark.end:]
    return text[:begin] + comment + rest


def write_anew(root, name, body, commit):
    """Rewrites the document that has the mark; body is None where it is no table's."""
    mark = next(mark for mark in all_marks(root) if mark.name == name)
    path = pathlib.Path(root, mark.document)
    path.write_text(made_anew(path.read_text(encoding="utf-8"), mark, body, commit), encoding="utf-8")
