"""Signs of points and lines: what tells marks apart where a colour alone would not."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from catseye.app.render.palette import look_of
from catseye.app.results.figures import Dash, Level, Line, Mark, Points, Shape
from catseye.app.tui.widgets.braille import Floats
from catseye.app.tui.widgets.chart import Chart

SEVERAL: Final = "✱"
"""Stands where signs of several kinds share a cell."""

_GLYPHS: Final = {"o": "●", "s": "■", "^": "▲", "v": "▼", "D": "◆", "P": "✚", ".": "·", "x": "×", "+": "+"}
_HOLLOW: Final = {"o": "○", "s": "□", "^": "△", "v": "▽", "D": "◇"}
_SMALL: Final = {"^": "▵", "v": "▿"}
_TOGETHER: Final = {
    frozenset("×○"): "⊗",
    frozenset("+○"): "⊕",
    frozenset("×□"): "⊠",
    frozenset("+□"): "⊞",
}
LINE_SAMPLES: Final[dict[Dash, str]] = {"solid": "──", "dashed": "╌╌", "dotted": "┈┈", "dash-dotted": "┄┄"}
_ROOMY: Final = 0.75
"""More points than this share of the columns are dots; a few of them have their sign."""

_FEW: Final = 7
_SIGNED: Final = 3.0
"""Smaller points than these are a cloud of dots where they are many."""

_LARGE, _MIDDLE = 0.6, 0.2
"""Shares of the largest area from which a sign is filled, or an outline."""

_SIGNS: Final = frozenset(
    {*_GLYPHS.values(), *_HOLLOW.values(), *_SMALL.values(), *_TOGETHER.values(), SEVERAL}
)
"""Letters that are signs, and not text."""


def sample(mark: Mark) -> str:
    """Return what stands for a mark in the legend."""
    match mark:
        case Line():
            return LINE_SAMPLES[mark.dash] + _line_glyph(mark)
        case Level():
            return LINE_SAMPLES[mark.dash]
        case Points():
            return glyph(mark)
        case Shape():
            return "┄┄" if mark.dashed else "──"
        case _:
            return "⠕⠕"


def glyph(mark: Points) -> str:
    """Return the sign of points."""
    marker = mark.marker or look_of(mark.ink).marker
    return _HOLLOW.get(marker, _GLYPHS[marker]) if mark.hollow else _GLYPHS[marker]


def _line_glyph(mark: Line) -> str:
    """Return the sign that a long solid line carries here and there: colour alone tells nothing apart."""
    if mark.dash != "solid" or mark.x.size <= _FEW:
        return ""
    return _HOLLOW.get(look_of(mark.ink).marker, "")


def write_point_signs(mark: Points, chart: Chart, ink: str) -> None:
    """Write the sign of points at each of them; at a few of very many, at none of a cloud of small ones."""
    places = np.arange(mark.x.size)
    if not mark.each and mark.x.size > _ROOMY * chart.plot_columns:
        places = _few(mark.x.size) if mark.size >= _SIGNED else places[:0]
    _write_signs(chart, mark.x[places], mark.y[places], glyph(mark), ink)


def write_line_signs(mark: Line, chart: Chart, ink: str) -> None:
    """Write the sign of a line at a few of its places, if it has one and is in the legend."""
    sign = _line_glyph(mark)
    if mark.label and sign:
        places = _few(mark.x.size)
        _write_signs(chart, mark.x[places], mark.y[places], sign, ink)


def _few(count: int) -> NDArray[np.intp]:
    """Return a few places among so many, evenly."""
    return np.linspace(0, count - 1, _FEW + 2)[1:-1].round().astype(np.intp)


def _write_signs(chart: Chart, x: Floats, y: Floats, sign: str, ink: str) -> None:
    for place in zip(x.tolist(), y.tolist(), strict=True):
        _write_sign(chart, *place, sign, ink)


def _write_sign(chart: Chart, x: float, y: float, sign: str, ink: str) -> None:
    if math.isfinite(x) and math.isfinite(y) and chart.inside(x, y):
        column, row = chart.cell(x, y)
        before = chart.canvas.letter(column, row)
        if before not in _SIGNS or before in (sign, _GLYPHS["."]):
            chart.canvas.text(column, row, sign, ink)
        elif sign != _GLYPHS["."]:
            chart.canvas.text(column, row, _TOGETHER.get(frozenset((before, sign)), SEVERAL), ink)


def write_areas(mark: Points, chart: Chart, ink: str) -> None:
    """Write large values as filled signs, smaller ones as outlines and dots."""
    marker = mark.marker or look_of(mark.ink).marker
    largest = 1.0 if mark.area is None else max(float(np.max(mark.area, initial=0.0)), 1e-12)
    for x, y, area in zip(mark.x, mark.y, np.zeros(0) if mark.area is None else mark.area, strict=True):
        small = _SMALL.get(marker, _GLYPHS["."]) if area > _MIDDLE * largest else _GLYPHS["."]
        _write_sign(chart, float(x), float(y), _GLYPHS[marker] if area > _LARGE * largest else small, ink)


def write_values(mark: Points, chart: Chart, ink: str) -> None:
    """Write values as digits, 0 at the lower end of their scale and 9 at the upper."""
    value = np.zeros(0) if mark.value is None else mark.value
    low, high = value_ends(mark)
    share = np.clip((value - low) / (high - low if high > low else 1.0), 0.0, 1.0)
    for x, y, digit in zip(mark.x, mark.y, np.nan_to_num(9.0 * share).round().astype(int), strict=True):
        if chart.inside(float(x), float(y)):
            chart.canvas.text(*chart.cell(float(x), float(y)), str(digit), ink)


def value_ends(mark: Points) -> tuple[float, float]:
    """Return the ends of the scale of coloured points."""
    if mark.value_ends is not None or mark.value is None or not mark.value.size:
        return mark.value_ends or (0.0, 1.0)
    return float(np.nanmin(mark.value)), float(np.nanmax(mark.value))
