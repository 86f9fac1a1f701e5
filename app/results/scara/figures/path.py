"""Measured and predicted deviations along the validation path (Figs 9 and 10 of the SCARA paper)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.app.results.figures import Axis, Band, Figure, Level, Line, Mark, Panel, Points, Role, Span
from catseye.app.results.scara.path_view import (
    Gap,
    PathAxis,
    arrow_of,
    model_title,
    path_axis,
    shown_errors,
    there,
)
from catseye.app.results.scara.validation import ModelOnPath, PathValidation
from catseye.calibration.core.types import Bools, Floats

_DENSE = 60
"""More rows a way are drawn as a line with a band, fewer as markers with error bars."""

_ZERO = Level(0.0, Role.AXIS, width=0.6)


@dataclass(frozen=True)
class _Column:
    """One model on the path.

    Attributes:
        model: the model.
        axis: of the path.
        way: which rows belong to the way there.
        first: it is the leftmost one, whose axes have labels.
        lines: how many the path has.
        measured_mm: measured errors, shape (n, 2).
        predicted_mm: predicted errors, shape (n, 2).
    """

    model: ModelOnPath
    axis: PathAxis
    way: Bools
    first: bool
    lines: int
    measured_mm: Floats
    predicted_mm: Floats

    @property
    def dense(self) -> bool:
        """There are too many rows for markers with error bars; a line would join the ends of several."""
        return self.lines == 1 and bool(self.way.sum() > _DENSE)


def path_figures(validation: PathValidation, gaps: Sequence[Gap] = ()) -> list[Figure]:
    """Return a figure for each deviation: a column for each model, and below it what the model leaves.

    The measurement is aligned as `shown_errors` says.

    Args:
        gaps: stretches that are not compared.
    """
    axis, way = path_axis(validation.path), there(validation.path)
    columns = [
        _Column(model, axis, way, not i, len(validation.path.lines), *shown_errors(validation, model))
        for i, model in enumerate(validation.models)
    ]
    reasons = list(dict.fromkeys(gap.reason for gap in gaps))
    stretches = tuple(Span(gap.low_mm, gap.high_mm, gap.reason, reasons.index(gap.reason)) for gap in gaps)
    return [
        _figure(columns, row, stretches, corrected=validation.uncorrected_mm is not None) for row in (0, 1)
    ]


def _figure(columns: Sequence[_Column], row: int, stretches: tuple[Span, ...], *, corrected: bool) -> Figure:
    symbol, meaning, component = columns[0].axis.deviations[row]
    return Figure(
        f"path-{'xy'[component]}",
        f"{meaning.capitalize()} along the validation path",
        f"{symbol.replace('{', '').replace('}', '')}: {meaning}, {_difference(corrected=corrected)} × there, + back: "
        "measured; circles, squares or lines: predicted, error bars or bands: U of the prediction (k = 2). "
        "Below: measured minus predicted; the band: ±U of that difference. "
        "Bands over the whole height: not compared. Arrows in the legend: the direction of driving.",
        tuple(
            tuple(panel(place, column, row, stretches) for place, column in enumerate(columns))
            for panel in (_deviation, _left)
        ),
        heights=(2.2, 1.0),
        aspect=0.6,
        legend_columns=3,
    )


def _difference(*, corrected: bool) -> str:
    if corrected:
        return (
            "actual minus wished position, all in the frame of the last model; predictions are made for the "
            "corrected commands that were driven."
        )
    return "actual minus command position."


def _deviation(place: int, column: _Column, row: int, grey: tuple[Span, ...]) -> Panel:
    symbol, _, component = column.axis.deviations[row]
    title = f"{'abcdef'[place]}) {model_title(column.model)}"
    upwards = Axis("µm", symbol) if column.first else Axis(shared=True)
    marks = (*grey, _ZERO, *_measured(column, component), *_predicted(column, component))
    return Panel(title, Axis(shared=True), upwards, marks)


def _left(_place: int, column: _Column, row: int, grey: tuple[Span, ...]) -> Panel:
    """Return measured minus predicted, and what is expected of it by the stated uncertainties."""
    component, along = column.axis.deviations[row][2], column.axis.values_mm
    order = np.argsort(along, kind="stable")
    u_um = 1e3 * column.model.agreement.u_mm[order, component]
    left_um = 1e3 * column.model.comparison.difference_mm[:, component]
    marks: list[Mark] = [
        *grey,
        _ZERO,
        Band.around(along[order], np.zeros_like(u_um), u_um, Role.EXPECTED, "±U of the difference"),
    ]
    marks += [
        Points(along[rows], left_um[rows], ink, marker=marker, size=3.5)
        for rows, ink, marker in ((column.way, Role.POSITIVE, "x"), (~column.way, Role.NEGATIVE, "+"))
    ]
    upwards = Axis("difference / µm") if column.first else Axis(shared=True)
    return Panel("", Axis(column.axis.label), upwards, tuple(marks))


def _measured(column: _Column, component: int) -> list[Mark]:
    error_um = 1e3 * column.measured_mm[:, component]
    ways = ((column.way, Role.POSITIVE, "x", "there"), (~column.way, Role.NEGATIVE, "+", "back"))
    size = 3.5 if column.dense else 5.0
    return [
        Points(
            column.axis.values_mm[rows],
            error_um[rows],
            ink,
            f"measured, way {name} {arrow_of(column.axis.values_mm[rows])}",
            marker=marker,
            size=size,
        )
        for rows, ink, marker, name in ways
    ]


def _predicted(column: _Column, component: int) -> list[Mark]:
    error_um = 1e3 * column.predicted_mm[:, component]
    u_um = 1e3 * column.model.prediction.u_mm[:, component]
    way = column.way
    both = (
        (way, Role.POSITIVE, "o", "error map, way there"),
        (~way, Role.NEGATIVE, "s", "error map, way back"),
    )
    one = ((way | ~way, Role.CONVENTIONAL, "o", "conventional model"),)
    marks: list[Mark] = []
    for rows, ink, marker, name in one if column.model.model == "conventional" else both:
        along, value, u = column.axis.values_mm[rows], error_um[rows], u_um[rows]
        if column.dense:
            marks += [Line(along, value, ink, name, width=1.0), Band.around(along, value, u, ink)]
        else:
            marks.append(Points(along, value, ink, name, u, marker=marker, size=5.0, hollow=True))
    return marks
