"""Marks of a figure drawn on a chart."""

import math
from functools import singledispatch
from typing import Final

import numpy as np

from catseye.app.results.figures import (
    Arrow,
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
from catseye.app.tui.widgets.chart import AXIS, Chart
from catseye.app.tui.widgets.inks import ink_name
from catseye.app.tui.widgets.mark_signs import write_areas, write_line_signs, write_point_signs, write_values
from catseye.app.tui.widgets.shape_outline import outline, within

SHADES: Final = "░▒▓█"
"""From zero to the highest value of a heat map."""

_HEADS: Final = "→↗↑↖←↙↓↘"
"""Heads of arrows, by eighths of a turn from the right."""

_DASHES: Final[dict[Dash, int]] = {"solid": 0, "dashed": 4, "dotted": 1, "dash-dotted": 2}


def layer(mark: Mark) -> int:
    """Return what is drawn first: what fills areas lies below lines, signs lie above them."""
    if isinstance(mark, Span | Band | Heat | Bars) or (isinstance(mark, Shape) and mark.filled):
        return 0
    return 2 if isinstance(mark, Points | Text | Arrow) else 1


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
    write_line_signs(mark, chart, ink)


@draw.register
def _(mark: Points, chart: Chart) -> None:
    ink = ink_name(mark.ink, faint=mark.faint)
    if mark.half_bar is not None:
        chart.bars(mark.x, mark.y - mark.half_bar, mark.y + mark.half_bar, ink)
    if mark.joined:
        chart.line(mark.x, mark.y, ink)
    if mark.value is not None:
        write_values(mark, chart, ink)
    elif mark.area is not None:
        write_areas(mark, chart, ink)
    else:
        chart.points(mark.x, mark.y, ink)
        write_point_signs(mark, chart, ink)


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
        kept = within(mark, x, y)
        chart.points(x[kept], y[kept], ink_name(mark.ink, faint=True))
    if mark.outlined:
        x, y = outline(mark)
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
def _(mark: Arrow, chart: Chart) -> None:
    if chart.inside(*mark.at):
        eighths = round(4.0 / math.pi * math.atan2(mark.towards[1], mark.towards[0]))
        column, row = chart.cell(*mark.at)
        chart.canvas.text(column, row, _HEADS[eighths % len(_HEADS)], ink_name(mark.ink))


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
