"""Error vectors on the validation path, magnified (Fig. 11 of the SCARA paper)."""

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from app.analysis.validation import PathMeasurement, PathValidation
from app.report.content import MODEL_TITLES
from app.report.figures.canvas import NEGATIVE, POSITIVE, STYLE, WIDTH_IN
from app.report.path_view import there
from calibration.types import Floats

MAGNIFICATION = 1000
"""An error of 200 µm is drawn 200 mm long."""

_SCALE_UM = 200


@rc_context(STYLE)
def vector_figure(validation: PathValidation) -> Figure:
    """Draw command positions and magnified errors: measured, each model, what the last model leaves."""
    last = validation.models[-1]
    panels = [("measured", last.comparison.measured_error_mm)]
    panels += [(MODEL_TITLES[m.model], m.prediction.error_mm) for m in reversed(validation.models)]
    panels.append(("= a − b", last.comparison.difference_mm))
    figure = Figure(figsize=(WIDTH_IN, 5.2))
    row = figure.subplots(1, len(panels), sharex=True, sharey=True)
    for letter, axes, (name, error_mm) in zip("abcdef", row, panels, strict=False):
        _vectors(axes, validation.path, error_mm)
        axes.set_title(f"{letter}) {name}", fontsize=8.5)
        axes.set_xlabel("X / mm")
    row[0].set_ylabel("Y / mm")
    _limits(row[0], validation.path, [error for _, error in panels])
    _scale(row[0])
    handles, labels = row[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=3)
    return figure


def _vectors(axes: Axes, path: PathMeasurement, error_mm: Floats) -> None:
    axes.set_aspect("equal", adjustable="box")
    ends = path.command_mm + MAGNIFICATION * error_mm
    axes.plot(*path.command_mm.T, ".", color="black", markersize=2.5, label="command position")
    way = there(path)
    for rows, colour, marker, name in ((way, POSITIVE, "o", "there"), (~way, NEGATIVE, "s", "back")):
        start, end = path.command_mm[rows], ends[rows]
        gap = np.full((len(start), 2), np.nan)
        lines = np.stack([start, end, gap], axis=1).reshape(-1, 2)
        axes.plot(*lines.T, color=colour, linewidth=0.5, alpha=0.6)
        axes.plot(
            *end.T,
            marker,
            color=colour,
            markersize=3.2,
            markerfacecolor="none",
            markeredgewidth=0.8,
            label=f"way {name}, error × {MAGNIFICATION}",
        )


def _limits(axes: Axes, path: PathMeasurement, errors_mm: list[Floats]) -> None:
    ends = np.concatenate([path.command_mm, *(path.command_mm + MAGNIFICATION * e for e in errors_mm)])
    low, high = np.nanmin(ends, axis=0), np.nanmax(ends, axis=0)
    room = 0.06 * np.max(high - low)
    axes.set_xlim(low[0] - room, max(high[0], low[0] + _SCALE_UM) + room)
    axes.set_ylim(low[1] - 3.0 * room, high[1] + room)


def _scale(axes: Axes) -> None:
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    length = MAGNIFICATION * 1e-3 * _SCALE_UM
    start, height = left + 0.06 * (right - left), bottom + 0.035 * (top - bottom)
    axes.plot([start, start + length], [height, height], color="black", linewidth=2.0, solid_capstyle="butt")
    axes.text(
        start + 0.5 * length,
        height + 0.012 * (top - bottom),
        f"{_SCALE_UM} µm",
        ha="center",
        va="bottom",
        fontsize=8,
    )
