"""Trajectories in the plane with their errors magnified (Fig. 11 of the SCARA paper)."""

from dataclasses import dataclass

import numpy as np

from catseye.app.results.figures import (
    Arrow,
    Axis,
    Figure,
    Line,
    Mark,
    Panel,
    Point,
    Points,
    Role,
    Text,
    columns,
)
from catseye.app.results.scara.path_view import model_title, shown_errors, there
from catseye.app.results.scara.validation import PathMeasurement, PathValidation
from catseye.calibration.core.types import Bools, Floats

MAGNIFICATION = 1000
"""Of errors, where it shows them well: an error of 200 µm is drawn 200 mm long."""

_SMALLEST, _LARGEST = 0.04, 0.35
"""Shares of the path's extent between which the largest error is seen well."""

_STEPS = (1.0, 2.0, 5.0)
_DENSE = 120
"""Rows of a path beyond which not every error vector is drawn."""

_FEWEST = 3
"""Rows of a line from which on an arrow shows how it is driven."""

_TALL = 1.6
"""Paths that are taller than this many widths stand side by side."""


def magnification(validation: PathValidation) -> float:
    """Return what errors are magnified by: 1000, or the nearest of 1, 2, 5 × 10ⁿ that shows the largest well."""
    extent = float(np.max(np.ptp(validation.path.command_mm, axis=0)))
    errors = [error for _, error in _errors(validation)]
    largest = max(float(np.nanmax(np.hypot(*error.T))) for error in errors)
    if largest <= 0.0 or _SMALLEST * extent <= MAGNIFICATION * largest <= _LARGEST * extent:
        return float(MAGNIFICATION)
    wanted = (_LARGEST if MAGNIFICATION * largest > _LARGEST * extent else _SMALLEST) * extent / largest
    return _rounded_down(wanted) if wanted < MAGNIFICATION else _rounded_up(wanted)


def trajectory_figure(validation: PathValidation) -> Figure:
    """Return command path and magnified errors: measured, each model from the best on, what the best leaves."""
    errors, factor = _errors(validation), magnification(validation)
    width, height = np.ptp(validation.path.command_mm, axis=0)
    tall = bool(height > _TALL * width)
    across = len(errors) if tall else 2
    count = -(-len(errors) // across)
    frame = _frame(validation, factor)
    panels: list[Panel | None] = [
        _panel(place, len(errors), across, validation.path, error, factor, frame, name)
        for place, (name, error) in enumerate(errors)
    ]
    panels += [None] * (count * across - len(panels))
    return Figure(
        "trajectories",
        "Trajectories with magnified errors",
        _caption(factor, corrected=validation.uncorrected_mm is not None),
        tuple(tuple(panels[row * across : (row + 1) * across]) for row in range(count)),
        aspect=0.675 if tall else 0.0375 + 0.5 * count * frame.shape,
        legend_columns=3,
    )


def _caption(factor: float, *, corrected: bool) -> str:
    positions = "wished" if corrected else "command"
    last = (
        "Predictions are made for the corrected commands that were driven. The last panel, measured minus the best "
        "model, is what that model does not know of them."
        if corrected
        else "The last panel, measured minus the best model, is what a compensation with that model would leave."
    )
    return (
        f"Thin line with dots: {positions} positions; from there the error, magnified {factor:g} times (the bar "
        f"shows its scale), to where the arm was measured or is predicted. Arrows: the direction of driving. {last}"
    )


def _errors(validation: PathValidation) -> list[tuple[str, Floats]]:
    """Return what each panel shows: name and error, mm, shape (n, 2)."""
    last = validation.models[-1]
    errors = [("measured", last.comparison.measured_error_mm)]
    errors += [
        (model_title(model), shown_errors(validation, model)[1]) for model in reversed(validation.models)
    ]
    return [*errors, ("= a − b", last.comparison.difference_mm)]


@dataclass(frozen=True)
class _Frame:
    """Ends of both axes of every panel, mm, and the scale bar.

    Attributes:
        x: from left to right.
        y: from bottom to top.
        shape: height over width of a panel, within what a page bears.
        scale_um: error that is drawn as long as the bar.
    """

    x: Point
    y: Point
    shape: float
    scale_um: float


def _frame(validation: PathValidation, factor: float) -> _Frame:
    command = validation.path.command_mm
    ends = np.concatenate([command, *(command + factor * error for _, error in _errors(validation))])
    low, high = np.nanmin(ends, axis=0), np.nanmax(ends, axis=0)
    width, height = (float(side) for side in high - low)
    longest = max(width, height)
    room, scale_um = 0.06 * longest, _rounded_up(150.0 * longest / factor)
    right = max(float(high[0]), float(low[0]) + 1e-3 * factor * scale_um) + room
    return _Frame(
        (float(low[0]) - room, right),
        (float(low[1]) - 2.6 * room, float(high[1]) + room),
        float(np.clip((height + 0.2 * longest) / (width + 0.12 * longest), 0.45, 1.1)),
        scale_um,
    )


def _panel(
    place: int,
    count: int,
    across: int,
    path: PathMeasurement,
    error_mm: Floats,
    factor: float,
    frame: _Frame,
    name: str,
) -> Panel:
    lowest, first = place + across >= count, place % across == 0
    return Panel(
        f"{'abcdef'[place]}) {name}",
        Axis("X / mm" if lowest else "", low=frame.x[0], high=frame.x[1], shared=not lowest),
        Axis("Y / mm" if first else "", low=frame.y[0], high=frame.y[1], shared=not first),
        (*_trajectory(path, error_mm, factor), *_scale(frame, factor)),
        equal=True,
    )


def _trajectory(path: PathMeasurement, error_mm: Floats, factor: float) -> list[Mark]:
    ends = path.command_mm + factor * error_mm
    starts = [rows.start for rows in path.lines]
    every = max(1, len(ends) // _DENSE)
    marks: list[Mark] = [
        Line(*columns(np.insert(path.command_mm, starts[1:], np.nan, axis=0)), Role.PATH, width=0.6),
        Points(*columns(path.command_mm[::every]), Role.TRUTH, "command position", size=2.5),
    ]
    way = there(path)
    for rows, ink, marker, name in (
        (way, Role.POSITIVE, "o", "there"),
        (~way, Role.NEGATIVE, "s", "back"),
    ):
        if not rows.any():
            continue
        # A row of the other way or one without a number interrupts the line, and so does the end of one.
        drawn = np.insert(np.where(rows[:, None], ends, np.nan), starts[1:], np.nan, axis=0)
        marks.append(Line(*columns(drawn), ink, width=0.9))
        own = np.flatnonzero(rows)[::every]
        gap = np.full((own.size, 2), np.nan)
        vectors = np.stack([path.command_mm[own], ends[own], gap], axis=1).reshape(-1, 2)
        label = f"way {name}, error × {factor:g}"
        marks += [
            Line(*columns(vectors), ink, width=0.4, faint=True),
            Points(*columns(ends[own]), ink, label, marker=marker, size=2.8, hollow=True),
            *_heads(path, ends, rows, ink),
        ]
    if path.numbers is not None and len(starts) > 1:
        marks += [Text(f"{path.numbers[start]}", _place(path.command_mm[start])) for start in starts]
    return marks


def _heads(path: PathMeasurement, ends: Floats, way: Bools, ink: Role) -> list[Mark]:
    """Return an arrow in the middle of each line driven that way."""
    heads: list[Mark] = []
    for line in path.lines:
        own = np.flatnonzero(way[line] & np.isfinite(ends[line, 0])) + (line.start or 0)
        if own.size < _FEWEST:
            continue
        before, at, after = own[own.size // 2 - 1], own[own.size // 2], own[own.size // 2 + 1]
        step = path.command_mm[after] - path.command_mm[before]
        heads.append(Arrow(_place(ends[at]), _place(step), ink))
    return heads


def _place(xy: Floats) -> Point:
    return float(xy[0]), float(xy[1])


def _scale(frame: _Frame, factor: float) -> tuple[Mark, ...]:
    """Return a bar as long as an error of so many micrometres, with its length."""
    (left, right), (bottom, top) = frame.x, frame.y
    length = factor * 1e-3 * frame.scale_um
    start, height = left + 0.05 * (right - left), bottom + 0.03 * (top - bottom)
    bar = Line(np.array([start, start + length]), np.array([height, height]), Role.TRUTH, width=2.0)
    place = (start + 0.5 * length, height + 0.012 * (top - bottom))
    return bar, Text(f"error {frame.scale_um:g} µm", place, centred=True)


def _rounded_down(value: float) -> float:
    decade = 10.0 ** np.floor(np.log10(value))
    return float(decade * max(step for step in _STEPS if step * decade <= value * (1.0 + 1e-9)))


def _rounded_up(value: float) -> float:
    decade = 10.0 ** np.floor(np.log10(value))
    return float(decade * min(step for step in (*_STEPS, 10.0) if step * decade >= value * (1.0 - 1e-9)))
