"""Mistakes in commands, units, names and places: the same case with each of them undone."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.plausibility.bounded_fit import BoundedFit
from catseye.calibration.scara.plausibility.case import Case
from catseye.calibration.scara.plausibility.findings import (
    AngleSignReversed,
    AnglesInRadians,
    DisplacementScaled,
    DisplacementSignReversed,
    Joint,
    LinksExchanged,
    Mirror,
    Mistake,
    NamesExchanged,
    OtherLinks,
    PlacesMirrored,
    RowsShifted,
)
from catseye.calibration.scara.points import Points

_JOINTS: Final[tuple[tuple[Joint, ...], ...]] = ((1,), (2,), (1, 2))

_MIRRORS: Final[dict[Mirror, Floats]] = {
    "y": np.diag([1.0, -1.0]),
    "x": np.diag([-1.0, 1.0]),
    "both": -np.eye(2),
    "exchanged": np.array([[0.0, 1.0], [1.0, 0.0]]),
}


@dataclass(frozen=True)
class Correction:
    """A case with one mistake undone.

    Attributes:
        case: to be solved.
        freedom: how many numbers the correction takes from the distances; of equals the simpler one is believed.
        mistake: names the mistake by the solution.
    """

    case: Case
    freedom: int
    mistake: Callable[[BoundedFit], Mistake]


def corrections(case: Case) -> Iterator[Correction]:
    """Return the case with each mistake undone that concerns whole columns, names, links or places."""
    yield from _of_angles(case)
    points = case.points
    reversed_ = replace(points, displacement_mm=-points.displacement_mm)
    yield _plain(case.of_points(reversed_), DisplacementSignReversed())
    yield from _of_scale(case)
    one, two = case.links_mm
    yield _plain(replace(case, links_mm=(two, one)), LinksExchanged())
    yield Correction(replace(case, free="links"), 2, lambda fit: OtherLinks(*fit.parameters[:2].tolist()))
    for rows in (1, -1):
        yield _plain(case.of_points(shifted(points, rows)), RowsShifted(rows))
    for first, second in combinations(range(len(points.reflector_names)), 2):
        places = case.places_mm.copy()
        places[[first, second]] = places[[second, first]]
        names = points.reflector_names[first], points.reflector_names[second]
        yield _plain(replace(case, places_mm=places), NamesExchanged(*names))
    for mirror, matrix in _MIRRORS.items():
        yield _plain(replace(case, places_mm=case.places_mm @ matrix), PlacesMirrored(mirror))


def shifted(points: Points, rows: int) -> Points:
    """Return points whose displacements are those so many rows further down, of the same dead path."""
    size = len(points)
    here = np.arange(max(0, -rows), size - max(0, rows))
    kept = here[points.dead_path[here] == points.dead_path[here + rows]]
    displacement = points.displacement_mm[kept + rows]
    return replace(points.rows(kept), displacement_mm=displacement)


def scale_of(case: Case) -> float:
    """Return about how many mm a unit of displacement is, by the rough places; of reversed sign below 0.

    NaN where nothing changes.
    """
    commands, points = case.points.commands, case.points
    axis = forward(commands.theta1_rad, commands.theta2_rad, *case.links_mm)
    length = np.linalg.norm(axis - case.places_mm[points.reflector], axis=1)
    expected, found = _centred(length, points), _centred(points.displacement_mm, points)
    size = float(np.linalg.norm(found))
    if size == 0.0 or not expected.any():
        return math.nan
    return math.copysign(float(np.linalg.norm(expected)) / size, float(expected @ found))


def _of_angles(case: Case) -> Iterator[Correction]:
    for joints in _JOINTS:
        yield _plain(_turned(case, joints, -1.0), AngleSignReversed(joints))
    commands = case.points.commands
    largest = {1: np.abs(commands.theta1_rad).max(), 2: np.abs(commands.theta2_rad).max()}
    for joints in _JOINTS:
        # Read as deg and turned into rad they were made small by 180/π.
        if all(largest[joint] <= math.radians(2.0 * math.pi) for joint in joints):
            yield _plain(_turned(case, joints, 180.0 / math.pi), AnglesInRadians(joints))


def _turned(case: Case, joints: tuple[Joint, ...], factor: float) -> Case:
    commands = case.points.commands
    one = commands.theta1_rad * (factor if 1 in joints else 1.0)
    two = commands.theta2_rad * (factor if 2 in joints else 1.0)
    return case.of_points(replace(case.points, commands=replace(commands, theta1_rad=one, theta2_rad=two)))


def _of_scale(case: Case) -> Iterator[Correction]:
    about = abs(scale_of(case))
    if math.isnan(about):
        return
    points = replace(case.points, displacement_mm=about * case.points.displacement_mm)
    yield Correction(
        replace(case, points=points, free="scale"), 1, lambda fit: DisplacementScaled(about * fit.scale)
    )


def _plain(case: Case, mistake: Mistake) -> Correction:
    return Correction(case, 0, lambda _fit: mistake)


def _centred(values: Floats, points: Points) -> Floats:
    count = np.maximum(np.bincount(points.dead_path, minlength=len(points.dead_paths)), 1)
    means = np.bincount(points.dead_path, values, minlength=len(points.dead_paths)) / count
    return np.asarray(values - means[points.dead_path], dtype=np.float64)
