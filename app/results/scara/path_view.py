"""How a validation path is looked at: along which coordinate, and where the error map does not reach."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from catseye.app.results.numbers import PLAIN, number
from catseye.app.results.scara.names import MODEL_TITLES
from catseye.app.results.scara.result import MapTable, Result
from catseye.app.results.scara.validation import ModelOnPath, PathMeasurement, PathValidation
from catseye.calibration.core.types import Bools, Floats

_STRAIGHT = 0.01
"""A path that leaves a line by less than this share of its length counts as straight."""


@dataclass(frozen=True)
class PathAxis:
    """The coordinate along a path.

    Attributes:
        values_mm: of each row, shape (n,).
        label: what it is.
        title: the path in words.
        deviations: for each of two panels: symbol, what it is, component (0 is x, 1 is y).
    """

    values_mm: Floats
    label: str
    title: str
    deviations: tuple[tuple[str, str, int], tuple[str, str, int]]


@dataclass(frozen=True)
class Gap:
    """A stretch that is not predicted.

    Attributes:
        low_mm: where it begins on the axis.
        high_mm: where it ends.
        reason: why.
    """

    low_mm: float
    high_mm: float
    reason: str


class Path(Protocol):
    """What an axis is found for."""

    @property
    def command_mm(self) -> Floats:
        """Command positions, shape (n, 2)."""
        ...

    @property
    def lines(self) -> list[slice]:
        """The rows of each line, in order."""
        ...


def path_axis(path: Path) -> PathAxis:
    """Return the coordinate along a path: Y or X of a straight one, else the way along it, line after line."""
    x, y = path.command_mm.T
    if np.ptp(x) <= _STRAIGHT * np.ptp(y):
        return PathAxis(
            y,
            "Y / mm",
            f"X = {_plain(np.mean(x))} mm, Y = {_plain(y.min())} … {_plain(y.max())} mm",
            (("E_{YY}", "linear positioning deviation", 1), ("E_{XY}", "straightness deviation", 0)),
        )
    if np.ptp(y) <= _STRAIGHT * np.ptp(x):
        return PathAxis(
            x,
            "X / mm",
            f"Y = {_plain(np.mean(y))} mm, X = {_plain(x.min())} … {_plain(x.max())} mm",
            (("E_{XX}", "linear positioning deviation", 0), ("E_{YX}", "straightness deviation", 1)),
        )
    steps = np.hypot(np.diff(x, prepend=x[:1]), np.diff(y, prepend=y[:1]))
    # The way from line to line is none along the path.
    steps[[rows.start for rows in path.lines]] = 0.0
    several = f"{len(path.lines)} lines, " if len(path.lines) > 1 else ""
    return PathAxis(
        np.cumsum(steps),
        "way along the path / mm",
        f"{several}{np.sum(steps):.0f} mm in the plane",
        (("E_X", "error in x", 0), ("E_Y", "error in y", 1)),
    )


def _plain(value: float) -> str:
    return number(float(value), PLAIN)


def gaps(validation: PathValidation, error_map: Result | None) -> list[Gap]:
    """Return the stretches of the path's axis whose rows are not compared.

    Args:
        error_map: names the joint that leaves its nodes; without it the reason stays general.
    """
    axis = path_axis(validation.path)
    order = np.argsort(axis.values_mm, kind="stable")
    values, out = axis.values_mm[order], ~validation.compared[order]
    reasons = [
        _reason(validation, error_map, int(row)) if left else "" for row, left in zip(order, out, strict=True)
    ]
    return _stretches(values, reasons)


def _stretches(values: Floats, reasons: list[str]) -> list[Gap]:
    """Join neighbouring rows with one and the same reason; a stretch ends halfway to the next row."""
    middle = 0.5 * (values[1:] + values[:-1])
    edges = np.concatenate([values[:1], middle, values[-1:]])
    found: list[Gap] = []
    for i, reason in enumerate(reasons):
        if not reason:
            continue
        low, high = float(edges[i]), float(edges[i + 1])
        if found and found[-1].reason == reason and found[-1].high_mm >= low:
            low = found.pop().low_mm
        found.append(Gap(low, high, reason))
    return found


def _reason(validation: PathValidation, error_map: Result | None, row: int) -> str:
    commands = validation.path.commands
    beyond = [
        name
        for name, theta, table in (
            ("θ1", commands.theta1_rad, error_map.theta1_map if error_map else None),
            ("θ2", commands.theta2_rad, error_map.theta2_map if error_map else None),
        )
        if table is not None and _beyond(float(np.rad2deg(theta[row])), table)
    ]
    if beyond:
        return f"{' and '.join(beyond)} beyond the nodes: not predicted"
    return "not predicted" if validation.path.established[row] else "a joint has just reversed: not compared"


def _beyond(theta_deg: float, table: MapTable) -> bool:
    return not table.node_deg[0] - 1e-6 <= theta_deg <= table.node_deg[-1] + 1e-6


def shown_errors(validation: PathValidation, model: ModelOnPath) -> tuple[Floats, Floats]:
    """Return measured and predicted errors beside each other, mm, shape (n, 2) each.

    The measurement is aligned to the model. Of a corrected path the measured error is what counts: there it is the
    same beside every model, aligned to the last one, whose frame the predictions are brought into.
    """
    last = validation.models[-1]
    if validation.uncorrected_mm is None or model is last:
        return model.comparison.measured_error_mm, model.prediction.error_mm
    seen = model.comparison.transform.undo(model.prediction.position_mm)
    predicted = last.comparison.transform.apply(seen) - validation.path.command_mm
    return last.comparison.measured_error_mm, np.asarray(predicted, dtype=np.float64)


def there(path: PathMeasurement) -> Bools:
    """Return which rows belong to the way there, shape (n,)."""
    return np.asarray(path.travel > 0, dtype=np.bool_)


def arrow_of(values_mm: Floats) -> str:
    """Return in which direction of the axis rows were driven; empty for fewer than two."""
    steps = np.diff(values_mm)
    return ("→" if float(np.median(steps)) > 0.0 else "←") if steps.size else ""


def model_title(model: ModelOnPath) -> str:
    """Return what a reader calls a model."""
    return model.title or MODEL_TITLES[model.model]
