"""Measured and predicted deviations along the validation path (Figs 9 and 10 of the SCARA paper)."""

from collections.abc import Sequence

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from app.analysis.validation import ModelOnPath, PathValidation
from app.report.content import MODEL_TITLES
from app.report.figures.canvas import CONVENTIONAL, NEGATIVE, POSITIVE, STYLE, WIDTH_IN
from app.report.path_view import Gap, PathAxis, path_axis, there
from calibration.types import Bools


@rc_context(STYLE)
def path_figure(validation: PathValidation, gaps: Sequence[Gap] = ()) -> Figure:
    """Draw a column of panels for each model; the measurement is aligned to each model by itself.

    Args:
        validation: models on the path.
        gaps: stretches that are not compared.
    """
    axis, way = path_axis(validation.path), there(validation.path)
    figure = Figure(figsize=(WIDTH_IN, 6.2))
    panels = figure.subplots(2, len(validation.models), sharex=True, sharey="row", squeeze=False)
    for column, model in enumerate(validation.models):
        for row, (symbol, _, component) in enumerate(axis.deviations):
            axes = panels[row, column]
            _gaps(axes, gaps)
            _measured(axes, axis, model, way, component)
            _predicted(axes, axis, model, way, component)
            if column == 0:
                axes.set_ylabel(f"${symbol}$ / µm", parse_math=True)
        panels[0, column].set_title(f"{'abcdef'[column]}) {MODEL_TITLES[model.model]}")
        panels[1, column].set_xlabel(axis.label)
    handles = {
        label: handle
        for column in range(len(validation.models))
        for handle, label in zip(*panels[0, column].get_legend_handles_labels(), strict=True)
    }
    figure.legend(list(handles.values()), list(handles), loc="outside upper center", ncols=3)
    return figure


def _measured(axes: Axes, axis: PathAxis, model: ModelOnPath, way: Bools, component: int) -> None:
    error_um = 1e3 * model.comparison.measured_error_mm[:, component]
    for rows, colour, marker, name in ((way, POSITIVE, "x", "there"), (~way, NEGATIVE, "+", "back")):
        axes.plot(
            axis.values_mm[rows],
            error_um[rows],
            marker,
            color=colour,
            markersize=5.0,
            label=f"measured, way {name}",
        )


def _predicted(axes: Axes, axis: PathAxis, model: ModelOnPath, way: Bools, component: int) -> None:
    error_um = 1e3 * model.prediction.error_mm[:, component]
    u_um = 1e3 * model.prediction.u_mm[:, component]
    both = ((way, POSITIVE, "o", "error map, way there"), (~way, NEGATIVE, "s", "error map, way back"))
    one = ((way | ~way, CONVENTIONAL, "o", "conventional model"),)
    for rows, colour, marker, name in one if model.model == "conventional" else both:
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


def _gaps(axes: Axes, gaps: Sequence[Gap]) -> None:
    for gap in gaps:
        axes.axvspan(gap.low_mm, gap.high_mm, color="#e4e8ed", zorder=0.5, label=gap.reason)
