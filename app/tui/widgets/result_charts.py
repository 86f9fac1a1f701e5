"""Charts of a result: maps, differences of maps, residuals, a validation path, the layout."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.app.results.numbers import EXPANDED
from catseye.app.results.scara.validation_document import DeviationPart, PathPart
from catseye.app.tui.widgets.braille import Canvas, Floats
from catseye.app.tui.widgets.chart import AXIS, Chart, ends_of
from catseye.app.tui.widgets.inks import Line
from catseye.app.tui.widgets.plan_drawing import view_within

UP: Final = "up"
DOWN: Final = "down"
DOTS: Final = "dots"
OUTLIER: Final = "outlier"
FIRST_MODEL: Final = "first-model"
LAST_MODEL: Final = "last-model"
LIMIT: Final = "limit"

_NUMBERED: Final = 9
_LETTERS: Final = 7
_FEW_MARKS: Final = 2


@dataclass(frozen=True)
class MapColumns:
    """Values of one joint over its nodes, approached upwards and downwards.

    Attributes:
        title: of the chart, with the unit.
        node_deg: command angles, deg, shape (m,).
        positive: approached upwards, shape (m,).
        negative: approached downwards, shape (m,).
        u_positive: standard uncertainties, shape (m,); zero draws no bar.
        u_negative: standard uncertainties, shape (m,).
        limit: levels above and below zero that are drawn; 0 for none.
    """

    title: str
    node_deg: Floats
    positive: Floats
    negative: Floats
    u_positive: Floats
    u_negative: Floats
    limit: float = 0.0


def draw_map(columns: MapColumns, width: int, height: int) -> list[Line]:
    """Return a map with its bars: + approached upwards, − downwards, ± both in one place."""
    bars = EXPANDED * columns.u_positive, EXPANDED * columns.u_negative
    y = ends_of(
        columns.positive + bars[0],
        columns.positive - bars[0],
        columns.negative + bars[1],
        columns.negative - bars[1],
        np.array([columns.limit, -columns.limit]),
    )
    nodes = columns.node_deg
    x = float(nodes[0]), float(nodes[-1])
    step = float(np.diff(nodes).min()) if nodes.size > _FEW_MARKS else None
    chart = Chart(width, height, x, y, x_unit="deg", title=columns.title, x_step=step)
    if not chart.usable:
        return list(chart.canvas.lines())
    if columns.limit:
        chart.level(columns.limit, LIMIT)
        chart.level(-columns.limit, LIMIT)
    chart.line(nodes, columns.positive, UP)
    chart.line(nodes, columns.negative, DOWN)
    chart.bars(nodes, columns.positive - bars[0], columns.positive + bars[0], UP)
    chart.bars(nodes, columns.negative - bars[1], columns.negative + bars[1], DOWN, aside=1)
    above = {chart.cell(*place) for place in zip(nodes.tolist(), columns.positive.tolist(), strict=True)}
    for place in zip(nodes.tolist(), columns.positive.tolist(), strict=True):
        chart.letter(*place, "+", UP)
    for place in zip(nodes.tolist(), columns.negative.tolist(), strict=True):
        chart.letter(*place, "±" if chart.cell(*place) in above else "−", DOWN)
    return list(chart.canvas.lines())


def draw_residuals(
    residual_um: Floats, reflector: Sequence[str], outliers: Sequence[int], width: int, height: int
) -> list[Line]:
    """Return the residual of each distance in measuring order.

    Args:
        residual_um: predicted minus measured, µm, shape (n,).
        reflector: of each distance.
        outliers: numbers of distances, from 1; the first nine are numbered in the chart.
        width: in cells.
        height: in cells.
    """
    count = residual_um.size
    order = np.arange(1, count + 1, dtype=np.float64)
    ends = (1.0, float(max(count, 2)))
    title = "residual µm"
    chart = Chart(width, height, ends, ends_of(residual_um), x_unit="distance no.", title=title)
    if not chart.usable:
        return list(chart.canvas.lines())
    begins = [i for i in range(count) if i == 0 or reflector[i] != reflector[i - 1]]
    for begin in begins:
        if begin:
            chart.upright(begin + 0.5, AXIS)
        column = chart.cell(begin + 1.0, 0.0)[0]
        chart.canvas.text(max(column, len(title) + 2), 0, reflector[begin], AXIS)
    chart.points(order, residual_um, DOTS)
    for place, row in reversed(list(enumerate(outliers, 1))):
        if 1 <= row <= count:
            letter = str(place) if place <= _NUMBERED else "×"
            chart.letter(float(row), float(residual_um[row - 1]), letter, OUTLIER)
    return list(chart.canvas.lines())


def draw_path(path: PathPart, deviation: DeviationPart, width: int, height: int) -> list[Line]:
    """Return a deviation along a validation path: dots measured, lines with letters predicted.

    Args:
        path: that was measured.
        deviation: one of its deviations.
        width: in cells.
        height: in cells.
    """
    x, measured = np.array(path.axis_mm), np.array(deviation.measured_um)
    models = [np.array(values) for values in deviation.predicted_um]
    ends = float(np.min(x)), float(np.max(x))
    title = f"{deviation.symbol} µm"
    chart = Chart(width, height, ends, ends_of(measured, *models), x_unit="mm", title=title)
    if not chart.usable:
        return list(chart.canvas.lines())
    chart.points(x, measured, DOTS)
    inks = (FIRST_MODEL, LAST_MODEL)[-len(models) :]
    for values, ink, letter in zip(models, inks, "ce"[-len(models) :], strict=True):
        chart.points(x, values, ink)
        for row in np.linspace(0, x.size - 1, _LETTERS + 2)[1:-1].round().astype(int).tolist():
            chart.letter(float(x[row]), float(values[row]), letter, ink)
    return list(chart.canvas.lines())


def draw_layout(
    links_mm: tuple[float, float],
    reflectors: Sequence[tuple[str, float, float]],
    commands_deg: Floats,
    width: int,
    height: int,
) -> list[Line]:
    """Return reflectors and commands from above, to scale.

    Args:
        links_mm: identified links.
        reflectors: name, x and y, mm.
        commands_deg: θ1 and θ2 of the distances, shape (n, 2).
        width: in cells.
        height: in cells.
    """
    canvas = Canvas(width, height)
    if not (canvas.columns and canvas.rows):
        return []
    view = view_within(sum(links_mm), [(x_mm, y_mm) for _, x_mm, y_mm in reflectors], canvas)
    one, two = np.deg2rad(commands_deg).T
    x_mm = links_mm[0] * np.cos(one) + links_mm[1] * np.cos(one + two)
    y_mm = links_mm[0] * np.sin(one) + links_mm[1] * np.sin(one + two)
    canvas.points((x_mm - view.left_mm) / view.mm_per_dot, (view.top_mm - y_mm) / view.mm_per_dot, DOTS)
    canvas.arc(view.dot(0.0, 0.0), sum(links_mm) / view.mm_per_dot, 0.0, 2.0 * math.pi, AXIS, 2)
    _write(canvas, view.dot(0.0, 0.0), "╋", AXIS)
    for name, *place in reflectors:
        _write(canvas, view.dot(*place), f"◆{name}", LAST_MODEL)
    canvas.text(0, 0, "↑Y →X", AXIS)
    length_mm = next((each for each in (500, 200, 100, 50) if each / view.mm_per_dot / 2 <= width / 5), 0)
    cells = round(length_mm / view.mm_per_dot / 2)
    if cells > _FEW_MARKS:
        canvas.text(0, height - 1, f"├{'─' * (cells - 2)}┤ {length_mm} mm", AXIS)
    return list(canvas.lines())


def _write(canvas: Canvas, dot: tuple[float, float], text: str, ink: str) -> None:
    canvas.text(round(dot[0]) // 2, round(dot[1]) // 4, text, ink)
