"""Phrases that read badly stand neither in the program nor in its documents."""

import re
from itertools import pairwise
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[2]

ROOMS: Final = ("app", "calibration", "drivers", "procedures", "simulators")

BANNED: Final = {
    r"\blets? expect\b": "is expected from",
    r"\b(is|are|was|were) told (?!to\b)": "receives, hears of, is distinguished",
    r"\bgets to know\b": "learns",
    r"\bis let know\b": "is informed",
    r"\bhas it that\b": "says",
    r"\bof no use is\b": "cannot be used",
}
"""With what to write instead."""


def test_no_banned_phrase_is_written() -> None:
    files = [
        *(file for room in ROOMS for file in (ROOT / room).rglob("*.py")),
        *(ROOT / "docs").glob("*.md"),
        ROOT / "README.md",
    ]
    assert len(files) > 500
    found = [
        f"{file.relative_to(ROOT)}: {match[0]!r}: {instead}"
        for file in files
        for phrase, instead in BANNED.items()
        for match in re.finditer(phrase, " ".join(file.read_text(encoding="utf-8").split()))
    ]
    assert found == []


def test_no_line_of_a_paragraph_begins_like_a_numbered_item() -> None:
    pages = [*(ROOT / "docs").rglob("*.md"), ROOT / "README.md", ROOT / "CHANGELOG.md"]
    found = [
        f"{page.relative_to(ROOT)}: {after!r}"
        for page in pages
        for before, after in pairwise(page.read_text(encoding="utf-8").splitlines())
        if re.match(r"1[.)] ", after) and re.match(r"\w", before)
    ]
    assert found == []
