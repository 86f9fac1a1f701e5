"""Trajectories in the plane with their errors magnified (Fig. 11 of the SCARA paper)."""

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from catseye.app.analysis.validation import PathMeasurement, PathValidation
from catseye.app.report.figures.canvas import NEGATIVE, POSITIVE, STYLE, WIDTH_IN
from catseye.app.report.path_view import model_title, there
from catseye.calibration.core.types import Floats

MAGNIFICATION = 1000
"""Of errors, where it shows them well: an error of 200 µm is drawn 200 mm long."""

_SMALLEST, _LARGEST = 0.04, 0.35
"""Shares of the path's extent between which the largest error is seen well."""

_STEPS = (1.0, 2.0, 5.0)
_DENSE = 120
"""Rows of a path beyond which not every error vector is drawn."""

_TALL = 1.6
"""Paths that are taller than this many widths stand side by side."""


def magnification(validation: PathValidation) -> float:
    """Return what errors are magnified by: 1000, or the nearest of 1, 2, 5 × 10ⁿ that shows the largest well."""
    extent = float(np.max(np.ptp(validation.path.command_mm, axis=0)))
    panels = [error for _, error in _panels(validation)]
    largest = max(float(np.nanmax(np.hypot(*error.T))) for error in panels)
    if largest <= 0.0 or _SMALLEST * extent <= MAGNIFICATION * largest <= _LARGEST * extent:
        return float(MAGNIFICATION)
    wanted = (_LARGEST if MAGNIFICATION * largest > _LARGEST * extent else _SMALLEST) * extent / largest
    return _rounded_down(wanted) if wanted < MAGNIFICATION else _rounded_up(wanted)


@rc_context(STYLE)
def trajectory_figure(validation: PathValidation) -> Figure:
    """Draw command path and magnified errors: measured, each model from the best on, what the best leaves."""
    panels, factor = _panels(validation), magnification(validation)
    width, height = np.ptp(validation.path.command_mm, axis=0)
    tall = height > _TALL * width
    columns = len(panels) if tall else 2
    rows = -(-len(panels) // columns)
    figure = Figure(figsize=(WIDTH_IN, 5.4 if tall else 0.3 + 4.0 * rows * _shape(validation, factor)))
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for axes in grid.ravel()[len(panels) :]:
        axes.set_visible(False)
    for letter, axes, (name, error_mm) in zip("abcdef", grid.ravel(), panels, strict=False):
        _trajectory(axes, validation.path, error_mm, factor)
        axes.set_title(f"{letter}) {name}", fontsize=8.5)
    for axes in grid[-1]:
        axes.set_xlabel("X / mm")
    for axes in grid[:, 0]:
        axes.set_ylabel("Y / mm")
    low, high = _limits(validation, factor)
    room = 0.06 * float(np.max(high - low))
    scale_um = _rounded_up(150.0 * float(np.max(high - low)) / factor)
    grid[0, 0].set_xlim(low[0] - room, max(high[0], low[0] + 1e-3 * factor * scale_um) + room)
    grid[0, 0].set_ylim(low[1] - 2.6 * room, high[1] + room)
    for axes in grid.ravel()[: len(panels)]:
        _scale(axes, factor, scale_um)
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=3)
    return figure


def _panels(validation: PathValidation) -> list[tuple[str, Floats]]:
    last = validation.models[-1]
    panels = [("measured", last.comparison.measured_error_mm)]
    panels += [(model_title(model), model.prediction.error_mm) for model in reversed(validation.models)]
    return [*panels, ("= a − b", last.comparison.difference_mm)]


def _shape(validation: PathValidation, factor: float) -> float:
    """Return height over width of what is drawn, within what a page bears."""
    low, high = _limits(validation, factor)
    width, height = high - low
    return float(
        np.clip((height + 0.2 * max(width, height)) / (width + 0.12 * max(width, height)), 0.45, 1.1)
    )


def _limits(validation: PathValidation, factor: float) -> tuple[Floats, Floats]:
    command = validation.path.command_mm
    ends = np.concatenate([command, *(command + factor * error for _, error in _panels(validation))])
    return np.nanmin(ends, axis=0), np.nanmax(ends, axis=0)


def _trajectory(axes: Axes, path: PathMeasurement, error_mm: Floats, factor: float) -> None:
    axes.set_aspect("equal", adjustable="box")
    ends = path.command_mm + factor * error_mm
    every = max(1, len(ends) // _DENSE)
    axes.plot(*path.command_mm.T, "-", color="#9aa0a8", linewidth=0.6)
    axes.plot(*path.command_mm[::every].T, ".", color="black", markersize=2.5, label="command position")
    way = there(path)
    for rows, colour, marker, name in ((way, POSITIVE, "o", "there"), (~way, NEGATIVE, "s", "back")):
        if not rows.any():
            continue
        # A row of the other way or one without a number interrupts the line.
        axes.plot(*np.where(rows[:, None], ends, np.nan).T, color=colour, linewidth=0.9)
        own = np.flatnonzero(rows)[::every]
        gap = np.full((own.size, 2), np.nan)
        vectors = np.stack([path.command_mm[own], ends[own], gap], axis=1).reshape(-1, 2)
        axes.plot(*vectors.T, color=colour, linewidth=0.4, alpha=0.55)
        axes.plot(
            *ends[own].T,
            marker,
            color=colour,
            markersize=2.8,
            markerfacecolor="none",
            markeredgewidth=0.7,
            label=f"way {name}, error × {factor:g}",
        )


def _scale(axes: Axes, factor: float, scale_um: float) -> None:
    """Draw a bar as long as an error of so many micrometres."""
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    length = factor * 1e-3 * scale_um
    start, height = left + 0.05 * (right - left), bottom + 0.03 * (top - bottom)
    axes.plot([start, start + length], [height, height], color="black", linewidth=2.0, solid_capstyle="butt")
    axes.text(
        start + 0.5 * length,
        height + 0.012 * (top - bottom),
        f"error {scale_um:g} µm",
        ha="center",
        va="bottom",
        fontsize=7.5,
    )


def _rounded_down(value: float) -> float:
    decade = 10.0 ** np.floor(np.log10(value))
    return float(decade * max(step for step in _STEPS if step * decade <= value * (1.0 + 1e-9)))


def _rounded_up(value: float) -> float:
    decade = 10.0 ** np.floor(np.log10(value))
    return float(decade * min(step for step in (*_STEPS, 10.0) if step * decade >= value * (1.0 - 1e-9)))
