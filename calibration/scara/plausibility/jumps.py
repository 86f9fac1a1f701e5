"""Where distances stop belonging together: a zero that was lost, a reflector that was moved.

Each row is tried as the first after the event. What a step there takes off the sum of squares follows from one
decomposition of the solved case, without solving it again.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.plausibility.bounded_fit import BoundedFit, fitted
from catseye.calibration.scara.plausibility.bounds import Bounds
from catseye.calibration.scara.plausibility.case import Case
from catseye.calibration.scara.plausibility.corrections import Correction
from catseye.calibration.scara.plausibility.findings import ReflectorMoved, ZeroLost
from catseye.calibration.scara.points import FEWEST

_STILL_MM: Final = 0.02
"""A reflector that seems to be moved by less stands where it stood."""

_RIDGE: Final = 1e-9
"""Keeps steps apart from displacements that no distance distinguishes."""


@dataclass(frozen=True)
class _Step:
    """The likeliest event of its kind.

    Attributes:
        gain: what it takes off the weighted sum of squares.
        row: first one after it.
        later: the rows of the same dead path, or of the same reflector, from there on, shape (n,).
    """

    gain: float
    row: int
    later: Bools


def jumps(case: Case, fits: Sequence[BoundedFit], bounds: Bounds) -> Iterator[Correction]:
    """Return a case with the likeliest lost zero undone, and with the likeliest moved reflector.

    Args:
        fits: arms near which the distances are looked at, fitted to the same ones.
    """
    points = case.points
    zeros = [_likeliest(fit, points.dead_path, 1) for fit in fits]
    moves = [_likeliest(fit, points.reflector, 3) for fit in fits]
    for zero in _different([_refined(case, zero, bounds) for zero in zeros if zero is not None]):
        yield Correction(_with_zero(case, zero), 2, partial(_zero_lost, step=zero))
    for moved in _different(moves):
        yield Correction(_with_place(case, moved), 4, partial(_moved, step=moved))


def _different(steps: Sequence[_Step | None]) -> Iterable[_Step]:
    return {step.row: step for step in steps if step is not None}.values()


def _refined(case: Case, step: _Step, bounds: Bounds) -> _Step:
    """Return a lost zero with the row after which the new dead path, once it is known, fits better than the old."""
    fit = fitted(_with_zero(case, step), bounds)
    if fit is None:
        return step
    path = case.points.dead_path[step.row]
    rows = np.flatnonzero(case.points.dead_path == path)
    paths = fit.parameters[fit.layout.dead_path]
    beyond = fit.residuals_mm[rows] + np.where(step.later[rows], paths[-1], paths[path])
    old, new = ((case.weights[rows] * (beyond - length)) ** 2 for length in (paths[path], paths[-1]))
    cost = np.concatenate([[0.0], np.cumsum(old)])[:-1] + _from_here(new)
    best = int(np.argmin(cost[FEWEST : rows.size - FEWEST + 1])) + FEWEST
    later = np.zeros_like(step.later)
    later[rows[best:]] = True
    return _Step(step.gain, int(rows[best]), later)


def _likeliest(fit: BoundedFit, group: Ints, columns: int) -> _Step | None:
    """Return the step that explains most; None where every group is too short.

    Args:
        group: number of what the event concerns, shape (n,).
        columns: 1 for a step of the distance; 3 for one with a displacement of the reflector.
    """
    basis = np.linalg.qr(fit.solution.free)[0]
    rows = [np.flatnonzero(group == number) for number in np.unique(group)]
    steps = [_best_step(fit, basis, own, columns) for own in rows if own.size >= 2 * FEWEST]
    return max(steps, key=lambda step: step.gain, default=None)


def _best_step(fit: BoundedFit, basis: Floats, rows: Ints, columns: int) -> _Step:
    """Try a step at each row of a group, given in order; enough rows remain on either side."""
    weight = fit.case.weights[rows]
    effects = _effects(fit, rows)[:, :columns] * weight[:, None]
    products = _from_here(effects[:, :, None] * effects[:, None, :])
    along = _from_here(effects[:, :, None] * basis[rows][:, None, :])
    toward = _from_here(effects * (weight * fit.residuals_mm[rows])[:, None])
    ridge = _RIDGE * np.trace(products, axis1=1, axis2=2)[:, None, None] * np.eye(columns)
    matrix = products - along @ np.swapaxes(along, 1, 2) + ridge
    gain = np.einsum("ij,ij->i", toward, np.linalg.solve(matrix, toward[:, :, None])[:, :, 0])
    best = int(np.argmax(gain[FEWEST : rows.size - FEWEST + 1])) + FEWEST
    later = np.zeros(len(fit.case.points), dtype=np.bool_)
    later[rows[best:]] = True
    return _Step(float(gain[best]), int(rows[best]), later)


def _effects(fit: BoundedFit, rows: Ints) -> Floats:
    """Return what a unit of dead path, x and y does to distances, shape (rows, 3)."""
    place = fit.layout.reflectors.start + 2 * fit.case.points.reflector[rows]
    jacobian = fit.solution.jacobian
    return np.column_stack([-np.ones(rows.size), jacobian[rows, place], jacobian[rows, place + 1]])


def _from_here(values: Floats) -> Floats:
    """Return the sums over all rows from each one on, same shape."""
    return np.asarray(np.cumsum(values[::-1], axis=0)[::-1], dtype=np.float64)


def _with_zero(case: Case, step: _Step) -> Case:
    """Give the rows after a step a dead path of their own."""
    points = case.points
    path = points.dead_paths[points.dead_path[step.row]]
    return replace(
        case,
        points=replace(
            points,
            dead_path=np.where(step.later, len(points.dead_paths), points.dead_path),
            dead_paths=(*points.dead_paths, path),
        ),
    )


def _with_place(case: Case, step: _Step) -> Case:
    """Give the rows after a step a place of their own, and a dead path where a segment goes on."""
    points = case.points
    number = int(points.reflector[step.row])
    split = _with_zero(
        case, replace(step, later=step.later & (points.dead_path == points.dead_path[step.row]))
    )
    if not np.any(split.points.dead_path == points.dead_path[step.row]):
        split = case
    moved = replace(
        split.points,
        reflector=np.where(step.later, len(points.reflector_names), points.reflector),
        reflector_names=(*points.reflector_names, points.reflector_names[number]),
    )
    return replace(case, points=moved, places_mm=np.vstack([case.places_mm, case.places_mm[number]]))


def _zero_lost(found: BoundedFit, step: _Step) -> ZeroLost:
    points = found.case.points
    after = next(
        i
        for i in range(step.row - 1, -1, -1)
        if points.dead_paths[points.dead_path[i]] == points.dead_paths[-1]
    )
    before = int(points.dead_path[after])
    paths = found.parameters[found.layout.dead_path]
    name, segment = points.dead_paths[-1]
    # Displacements are relative to the zero: a longer dead path makes them smaller.
    number, jump_mm = found.case.number, float(paths[before] - paths[-1])
    return ZeroLost(name, segment, number(after), number(step.row), jump_mm)


def _moved(found: BoundedFit, step: _Step) -> ReflectorMoved | ZeroLost:
    points = found.case.points
    before = found.places_mm[points.reflector_names.index(points.reflector_names[-1])]
    x_mm, y_mm = (found.places_mm[-1] - before).tolist()
    if math.hypot(x_mm, y_mm) < _STILL_MM and points.dead_paths[-1] in points.dead_paths[:-1]:
        return _zero_lost(found, step)
    return ReflectorMoved(points.reflector_names[-1], found.case.number(step.row), (x_mm, y_mm))
