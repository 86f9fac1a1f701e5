"""Deviations of measured distances along a validation path."""

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from catseye.app.analysis.distance_validation import DistanceValidation, ModelOnDistances
from catseye.app.report.content import MODEL_TITLES
from catseye.app.report.figures.canvas import NEGATIVE, POSITIVE, STYLE, WIDTH_IN
from catseye.calibration.core.types import Bools, Floats


@rc_context(STYLE)
def distance_figure(distances: DistanceValidation) -> Figure:
    """Draw a panel for each model.

    Args:
        distances: models on the path.
    """
    figure = Figure(figsize=(WIDTH_IN, 3.4))
    panels = figure.subplots(1, len(distances.models), sharey=True, squeeze=False)[0]
    y, there = distances.path.command_mm[:, 1], distances.path.travel > 0
    for number, (axes, model) in enumerate(zip(panels, distances.models, strict=True)):
        _deviations(axes, model, y, there)
        axes.set_title(f"{'abcdef'[number]}) {MODEL_TITLES[model.model]}")
        axes.set_xlabel("Y / mm")
    panels[0].set_ylabel("predicted − measured / µm")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=2)
    return figure


def _deviations(axes: Axes, model: ModelOnDistances, y: Floats, there: Bools) -> None:
    drawn = np.isfinite(model.deviation_mm)
    for rows, colour, marker, name in ((there, POSITIVE, "o", "there"), (~there, NEGATIVE, "s", "back")):
        chosen = rows & drawn
        axes.errorbar(
            y[chosen],
            1e3 * model.deviation_mm[chosen],
            1e3 * model.u_mm[chosen],
            fmt=marker,
            color=colour,
            markersize=4.0,
            markerfacecolor="none",
            elinewidth=0.7,
            label=f"way {name}",
        )
