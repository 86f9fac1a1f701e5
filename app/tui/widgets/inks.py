"""Drawings and lines in the colours of the theme."""

from collections.abc import Iterable, Mapping

from textual.content import Content

Line = list[tuple[str, str]]
"""Pieces of text with their ink."""


def painted(lines: Iterable[Line], styles: Mapping[str, str], *, faded: bool = False) -> Content:
    """Return lines in their colours.

    Args:
        lines: pieces of text with their ink.
        styles: style of each ink; others are plain.
        faded: everything is dim: it is old.
    """
    pieces: list[tuple[str, str] | str] = []
    for number, line in enumerate(lines):
        if number:
            pieces.append("\n")
        pieces.extend((text, "dim" if faded and text.strip() else styles.get(ink, "")) for text, ink in line)
    return Content.assemble(*pieces)
