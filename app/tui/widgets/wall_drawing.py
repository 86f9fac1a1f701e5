"""Figures laid out in columns and rows that fill a place."""

from collections.abc import Sequence
from typing import Final

from catseye.app.results.figures import Figure
from catseye.app.tui.widgets.figure_drawing import draw_figure, rows_needed, side_by_side
from catseye.app.tui.widgets.inks import Line

_COLUMN: Final = 60
"""Narrower figures do not stand side by side."""

_BETWEEN: Final[Line] = [("   ", "")]


def draw_wall(figures: Sequence[Figure], width: int, height: int) -> tuple[list[Line], int]:
    """Return the first figures that have room, each as large as the place allows, and how many these are."""
    columns = max(min(width // _COLUMN, len(figures)), 1)
    gaps = len(_BETWEEN[0][0]) * (columns - 1)
    own = (width - gaps) // columns
    rows: list[tuple[Sequence[Figure], int]] = []
    left = height
    for first in range(0, len(figures), columns):
        row = figures[first : first + columns]
        needed = max(rows_needed(figure, own) for figure in row)
        if rows and needed > left:
            break
        rows.append((row, min(needed, left)))
        left -= rows[-1][1]
    lines: list[Line] = []
    for number, (row, needed) in enumerate(rows):
        more = left * (number + 1) // len(rows) - left * number // len(rows)
        lines += _side_by_side(row, own, needed + more)
    return lines, sum(len(row) for row, _ in rows)


def _side_by_side(row: Sequence[Figure], width: int, height: int) -> list[Line]:
    drawn = [_filled(draw_figure(figure, width, height), width, height) for figure in row]
    return side_by_side(drawn, _BETWEEN)


def _filled(lines: list[Line], width: int, height: int) -> list[Line]:
    """Return lines that are as long as the column, and as many as the place has."""
    return [_as_long(line, width) for line in lines] + [_as_long([], width)] * (height - len(lines))


def _as_long(line: Line, width: int) -> Line:
    """Return a line cut or filled to a width: one that is longer would be broken."""
    left, pieces = width, list[tuple[str, str]]()
    for text, ink in line:
        pieces.append((text[:left], ink))
        left -= len(pieces[-1][0])
    return [*pieces, (" " * left, "")]
