# SPDX-License-Identifier: MIT
"""Says which links of the documents lead nowhere: files that are not there, headings that a page does not have.
Fails, too, where README.md and docs are longer than their budget; decisions, evidence and studies do not count.

Usage: python3 tests/document_links.py
"""
import pathlib
import re
import subprocess
import sys

LINES = 5000  # decision 44
ROOT = pathlib.Path(__file__).resolve().parent.parent


def anchor_of(heading):
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", re.sub(r"[`*]", "", heading.strip().lower()))
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def without_blocks(text):
    return re.sub(r"```.*?```", "", text, flags=re.S)


def anchors_of(page):
    return {anchor_of(heading) for heading in re.findall(r"^#+ (.*)", without_blocks(page.read_text()), re.M)}


def dead_links(page):
    text = re.sub(r"`[^`\n]*`", "", without_blocks(page.read_text()))
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"https?:|mailto:", link):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        if not target.exists() or (anchor and target.suffix == ".md" and anchor not in anchors_of(target)):
            yield link


names = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.split()
dead = [f"{name}: {link}" for name in names if (ROOT / name).exists() for link in dead_links(ROOT / name)]
budgeted = re.compile(r"README\.md|docs/(?!decisions/|evidence/|study/).*")
counted = [ROOT / name for name in names if budgeted.fullmatch(name) and (ROOT / name).exists()]
lines = sum(len(page.read_text().splitlines()) for page in counted)
if lines > LINES:
    dead.append(f"README.md and docs have {lines} lines, at most {LINES} (decision 44)")
print(*dead, sep="\n", end="\n" if dead else "")
sys.exit(1 if dead else 0)
