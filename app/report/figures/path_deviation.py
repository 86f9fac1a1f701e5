"""Measured and predicted deviations along the validation path (Figs 9 and 10 of the SCARA paper)."""

from collections.abc import Sequence

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from catseye.app.analysis.validation import ModelOnPath, PathValidation
from catseye.app.report.figures.canvas import CONVENTIONAL, NEGATIVE, POSITIVE, STYLE, WIDTH_IN
from catseye.app.report.path_view import Gap, PathAxis, model_title, path_axis, there
from catseye.calibration.core.types import Bools, Floats

_DENSE = 60
"""More rows a way are drawn as a line with a band, fewer as markers with error bars."""


@rc_context(STYLE)
def path_figure(validation: PathValidation, gaps: Sequence[Gap] = ()) -> Figure:
    """Draw a column of panels for each model: both deviations, and below each what the model leaves of it.

    The measurement is aligned to each model by itself.

    Args:
        validation: models on the path.
        gaps: stretches that are not compared.
    """
    axis, way = path_axis(validation.path), there(validation.path)
    figure = Figure(figsize=(WIDTH_IN, 8.4))
    panels = figure.subplots(
        4, len(validation.models), sharex=True, sharey="row", squeeze=False, height_ratios=(2.2, 1, 2.2, 1)
    )
    for column, model in enumerate(validation.models):
        for row, (symbol, _, component) in enumerate(axis.deviations):
            upper, lower = panels[2 * row, column], panels[2 * row + 1, column]
            for axes in (upper, lower):
                _gaps(axes, gaps)
                axes.axhline(0.0, color="#5f6670", linewidth=0.6)
            _measured(upper, axis, model, way, component)
            _predicted(upper, axis, model, way, component)
            _left(lower, axis, model, way, component)
            if column == 0:
                upper.set_ylabel(f"${symbol}$ / µm", parse_math=True)
                lower.set_ylabel("difference / µm")
        panels[0, column].set_title(f"{'abcdef'[column]}) {model_title(model)}")
        panels[3, column].set_xlabel(axis.label)
    figure.align_ylabels(panels[:, 0])
    handles = {
        label: handle
        for axes in panels.ravel()
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    figure.legend(list(handles.values()), list(handles), loc="outside upper center", ncols=3)
    return figure


def _measured(axes: Axes, axis: PathAxis, model: ModelOnPath, way: Bools, component: int) -> None:
    error_um = 1e3 * model.comparison.measured_error_mm[:, component]
    size = 3.5 if way.sum() > _DENSE else 5.0
    for rows, colour, marker, name in ((way, POSITIVE, "x", "there"), (~way, NEGATIVE, "+", "back")):
        axes.plot(
            axis.values_mm[rows],
            error_um[rows],
            marker,
            color=colour,
            markersize=size,
            markeredgewidth=0.8,
            label=f"measured, way {name}",
        )


def _predicted(axes: Axes, axis: PathAxis, model: ModelOnPath, way: Bools, component: int) -> None:
    error_um = 1e3 * model.prediction.error_mm[:, component]
    u_um = 1e3 * model.prediction.u_mm[:, component]
    both = (
        (way, POSITIVE, "o", "error map, way there"),
        (~way, NEGATIVE, "s", "error map, way back"),
    )
    one = ((way | ~way, CONVENTIONAL, "o", "conventional model"),)
    for rows, colour, marker, name in one if model.model == "conventional" else both:
        if way.sum() > _DENSE:
            _band(axes, axis.values_mm[rows], error_um[rows], u_um[rows], colour, name)
            continue
        axes.errorbar(
            axis.values_mm[rows],
            error_um[rows],
            u_um[rows],
            fmt=marker,
            color=colour,
            markersize=5.0,
            markerfacecolor="none",
            elinewidth=0.7,
            label=name,
        )


def _band(axes: Axes, along: Floats, value: Floats, u: Floats, colour: str, name: str) -> None:
    axes.plot(along, value, color=colour, linewidth=1.0, label=name)
    axes.fill_between(along, value - u, value + u, color=colour, alpha=0.2, linewidth=0.0)


def _left(axes: Axes, axis: PathAxis, model: ModelOnPath, way: Bools, component: int) -> None:
    """Draw measured minus predicted, and what the stated uncertainties let expect of it."""
    order = np.argsort(axis.values_mm, kind="stable")
    expected_um = 2e3 * model.agreement.u_mm[order, component]
    axes.fill_between(
        axis.values_mm[order],
        -expected_um,
        expected_um,
        color="#c9b458",
        alpha=0.35,
        linewidth=0.0,
        label="±2 u of the difference",
    )
    left_um = 1e3 * model.comparison.difference_mm[:, component]
    for rows, colour, marker in ((way, POSITIVE, "x"), (~way, NEGATIVE, "+")):
        axes.plot(
            axis.values_mm[rows], left_um[rows], marker, color=colour, markersize=3.5, markeredgewidth=0.8
        )


def _gaps(axes: Axes, gaps: Sequence[Gap]) -> None:
    for gap in gaps:
        axes.axvspan(gap.low_mm, gap.high_mm, color="#e4e8ed", zorder=0.5, label=gap.reason)
