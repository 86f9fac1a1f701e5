"""Marks of a figure drawn on a chart, and where they end."""

import math
from collections.abc import Sequence
from functools import singledispatch
from itertools import pairwise
from typing import Final

import numpy as np

from catseye.app.render.palette import look_of
from catseye.app.results.figures import (
    Band,
    Bars,
    Dash,
    Heat,
    Level,
    Line,
    Mark,
    Points,
    Shape,
    Span,
    Stems,
    Text,
)
from catseye.app.tui.widgets.braille import Floats
from catseye.app.tui.widgets.chart import AXIS, Chart
from catseye.app.tui.widgets.inks import ink_name
from catseye.calibration.core.types import Bools

SHADES: Final = "░▒▓█"
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
_DASHES: Final[dict[Dash, int]] = {"solid": 0, "dashed": 4, "dotted": 1, "dash-dotted": 2}
_SAMPLES: Final[dict[Dash, str]] = {"solid": "──", "dashed": "╌╌", "dotted": "┈┈", "dash-dotted": "┄┄"}
_ROOMY: Final = 0.75
"""More points than this share of the columns are dots; a few of them have their sign."""

_FEW: Final = 7
_SIGNED: Final = 3.0
"""Smaller marks than these are a cloud of dots where they are many."""

_LARGE, _MIDDLE = 0.6, 0.2
"""Shares of the largest area from which a sign is filled, or an outline."""

Ends = tuple[Sequence[float] | Floats, Sequence[float] | Floats]


def sample(mark: Mark) -> str:
    """Return what stands for a mark in the legend."""
    match mark:
        case Line():
            return _SAMPLES[mark.dash] + _line_glyph(mark)
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


@singledispatch
def ends_of(mark: Mark) -> Ends:
    """Return x and y of places that the axes have to hold."""
    raise TypeError(type(mark).__name__)


@ends_of.register
def _(mark: Line) -> Ends:
    return mark.x, mark.y


@ends_of.register
def _(mark: Points) -> Ends:
    u = 0.0 if mark.u is None else mark.u
    return mark.x, np.concatenate([mark.y - u, mark.y + u])


@ends_of.register
def _(mark: Band) -> Ends:
    return mark.x, np.concatenate([mark.low, mark.high])


@ends_of.register
def _(mark: Bars) -> Ends:
    return mark.edges, [0.0, *mark.height]


@ends_of.register
def _(mark: Stems) -> Ends:
    return mark.x, [0.0, *mark.height]


@ends_of.register
def _(mark: Level) -> Ends:
    return ([mark.at], []) if mark.vertical else ([], [mark.at])


@ends_of.register
def _(mark: Span) -> Ends:
    return [mark.low, mark.high], []


@ends_of.register
def _(mark: Shape) -> Ends:
    return _outline(mark)


@ends_of.register
def _(mark: Heat) -> Ends:
    return np.ravel(mark.x), np.ravel(mark.y)


@ends_of.register
def _(mark: Text) -> Ends:
    return ([], []) if mark.at is None else ([mark.at[0]], [mark.at[1]])


def layer(mark: Mark) -> int:
    """Return what is drawn first: what fills areas lies below lines, signs lie above them."""
    if isinstance(mark, Span | Band | Heat | Bars) or (isinstance(mark, Shape) and mark.filled):
        return 0
    return 2 if isinstance(mark, Points | Text) else 1


@singledispatch
def draw(mark: Mark, _chart: Chart) -> None:
    """Draw a mark."""
    raise TypeError(type(mark).__name__)


@draw.register
def _(mark: Line, chart: Chart) -> None:
    x, y, ink = mark.x, mark.y, ink_name(mark.ink, faint=mark.faint)
    if mark.step:
        x, y = np.repeat(x, 2)[1:], np.repeat(y, 2)[:-1]
    chart.line(x, y, ink, _DASHES[mark.dash])
    if mark.label and _line_glyph(mark):
        few = np.linspace(0, mark.x.size - 1, _FEW + 2)[1:-1].round().astype(np.intp)
        _write_signs(chart, mark.x[few], mark.y[few], _line_glyph(mark), ink)


@draw.register
def _(mark: Points, chart: Chart) -> None:
    ink = ink_name(mark.ink, faint=mark.faint)
    if mark.u is not None:
        chart.bars(mark.x, mark.y - mark.u, mark.y + mark.u, ink)
    if mark.joined:
        chart.line(mark.x, mark.y, ink)
    if mark.value is not None:
        _write_values(mark, chart, ink)
    elif mark.area is not None:
        _write_areas(mark, chart, ink)
    else:
        chart.points(mark.x, mark.y, ink)
        if mark.size >= _SIGNED or mark.x.size <= _ROOMY * chart.plot_columns:
            _write_signs(chart, mark.x, mark.y, glyph(mark), ink)


@draw.register
def _(mark: Band, chart: Chart) -> None:
    order = np.argsort(mark.x, kind="stable")
    x, y = chart.lattice()
    low, high = (np.interp(x, mark.x[order], values[order]) for values in (mark.low, mark.high))
    kept = (y >= low) & (y <= high) & (x >= mark.x[order][0]) & (x <= mark.x[order][-1])
    chart.points(x[kept], y[kept], ink_name(mark.ink, faint=True))


@draw.register
def _(mark: Bars, chart: Chart) -> None:
    x = np.repeat(mark.edges, 2)
    chart.line(x, np.concatenate([[0.0], np.repeat(mark.height, 2), [0.0]]), ink_name(mark.ink))
    height = np.fmax(mark.height[1:], mark.height[:-1])
    chart.bars(mark.edges[1:-1], np.zeros(height.size), height, ink_name(mark.ink))


@draw.register
def _(mark: Stems, chart: Chart) -> None:
    chart.bars(mark.x, np.zeros(mark.x.size), mark.height, ink_name(mark.ink))


@draw.register
def _(mark: Level, chart: Chart) -> None:
    at, ends = np.full(2, mark.at), np.array(chart.y if mark.vertical else chart.x)
    dash = _DASHES[mark.dash] or (0 if mark.width > 1.0 else 2)
    x, y = (at, ends) if mark.vertical else (ends, at)
    chart.line(x, y, ink_name(mark.ink), dash)


@draw.register
def _(mark: Span, chart: Chart) -> None:
    x, y = chart.lattice()
    kept = (x >= mark.low) & (x <= mark.high)
    chart.points(x[kept], y[kept], AXIS)


@draw.register
def _(mark: Shape, chart: Chart) -> None:
    if mark.filled:
        x, y = chart.lattice()
        kept = _within(mark, x, y)
        chart.points(x[kept], y[kept], ink_name(mark.ink, faint=True))
    if mark.outlined:
        x, y = _outline(mark)
        chart.line(x, y, ink_name(mark.ink), _DASHES["dashed"] if mark.dashed else 0)


@draw.register
def _(mark: Heat, chart: Chart) -> None:
    x, y = chart.cells()
    places = np.column_stack([np.ravel(mark.x), np.ravel(mark.y)])
    values, ink = np.ravel(mark.value), ink_name("heat")
    spacing = np.array([np.ptp(chart.x), np.ptp(chart.y)]) / max(math.sqrt(places.shape[0]), 1.0)
    for row, column in np.ndindex(x.shape):
        away = np.max(np.abs((places - (x[row, column], y[row, column])) / spacing), axis=1)
        nearest = int(np.argmin(away))
        if away[nearest] <= 1.0 and math.isfinite(values[nearest]):
            share = min(max(values[nearest] / mark.highest, 0.0), 1.0 - 1e-9)
            chart.shade(row, column, SHADES[int(share * len(SHADES))], ink)


@draw.register
def _(mark: Text, chart: Chart) -> None:
    ink = ink_name(mark.ink)
    if mark.at is None:
        for row, line in enumerate(mark.text.splitlines()):
            chart.shade(row, 1, line, ink)
    elif chart.inside(*mark.at):
        column, row = chart.cell(*mark.at)
        if mark.centred:
            chart.canvas.text(column - len(mark.text) // 2, row - 1, mark.text, ink)
        else:
            chart.canvas.text(column + 1, row, mark.text, ink)


def _write_signs(chart: Chart, x: Floats, y: Floats, sign: str, ink: str) -> None:
    """Write a sign at each place, or at a few of very many."""
    places = np.arange(x.size)
    if x.size > _ROOMY * chart.plot_columns:
        places = np.linspace(0, x.size - 1, _FEW + 2)[1:-1].round().astype(np.intp)
    for place in places.tolist():
        _write_sign(chart, float(x[place]), float(y[place]), sign, ink)


def _write_sign(chart: Chart, x: float, y: float, sign: str, ink: str) -> None:
    if math.isfinite(x) and math.isfinite(y) and chart.inside(x, y):
        column, row = chart.cell(x, y)
        before = chart.canvas.letter(column, row)
        if before not in _SIGNS or before in (sign, _GLYPHS["."]):
            chart.canvas.text(column, row, sign, ink)
        elif sign != _GLYPHS["."]:
            chart.canvas.text(column, row, _TOGETHER.get(frozenset((before, sign)), SEVERAL), ink)


def _write_areas(mark: Points, chart: Chart, ink: str) -> None:
    """Write large values as filled signs, smaller ones as outlines and dots."""
    marker = mark.marker or look_of(mark.ink).marker
    largest = 1.0 if mark.area is None else max(float(np.max(mark.area, initial=0.0)), 1e-12)
    for x, y, area in zip(mark.x, mark.y, np.zeros(0) if mark.area is None else mark.area, strict=True):
        small = _SMALL.get(marker, _GLYPHS["."]) if area > _MIDDLE * largest else _GLYPHS["."]
        _write_sign(chart, float(x), float(y), _GLYPHS[marker] if area > _LARGE * largest else small, ink)


def _write_values(mark: Points, chart: Chart, ink: str) -> None:
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


def _outline(mark: Shape) -> tuple[Floats, Floats]:
    """Return the outline of a circle, an ellipse or a wedge; a wedge begins and ends in its middle."""
    whole = mark.to_deg - mark.from_deg >= 360.0
    angle, turn = np.deg2rad(np.linspace(mark.from_deg, mark.to_deg, 97)), math.radians(mark.turn_deg)
    along, across = mark.half[0] * np.cos(angle), mark.half[1] * np.sin(angle)
    if not whole:
        along, across = (np.concatenate([[0.0], side, [0.0]]) for side in (along, across))
    return (
        mark.centre[0] + along * math.cos(turn) - across * math.sin(turn),
        mark.centre[1] + along * math.sin(turn) + across * math.cos(turn),
    )


def _within(mark: Shape, x: Floats, y: Floats) -> Bools:
    """Return which places lie within a shape (even-odd rule over its outline), shape (n,)."""
    inside: Bools = np.zeros(x.shape, np.bool_)
    edge_x, edge_y = _outline(mark)
    corners = list(zip(edge_x.tolist(), edge_y.tolist(), strict=True))
    for (x0, y0), (x1, y1) in pairwise([*corners, corners[0]]):
        if y0 != y1:
            crosses = (y0 > y) != (y1 > y)
            inside ^= crosses & (x < x0 + (y - y0) / (y1 - y0) * (x1 - x0))
    return inside


_SIGNS: Final = frozenset(
    {*_GLYPHS.values(), *_HOLLOW.values(), *_SMALL.values(), *_TOGETHER.values(), SEVERAL}
)
