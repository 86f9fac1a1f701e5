"""Measurements as they would be without a mistake that somebody may have made in a table of poses."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.bodies import Point
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.joint_mistakes import in_radians, may_be_radians, misplaced
from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.misfit import fits, misfit_mm, residuals_mm
from catseye.calibration.serial_arm.orientations import places_only

LENGTHS_MM = {"m": 1000.0, "cm": 10.0, "inches": 25.4, "µm": 0.001}
"""Units in which lengths may have been written, mm."""

_SMALL_SHARE = 0.02
"""Of the usual distance from the instrument: a place nearer than this may be in another unit."""

_FEW_WRONG = 0.05
"""Share of the poses that may be so wrong that they hide how well the others fit."""

_MOST_TARGETS = 4
"""All orders of more targets are too many to try."""


@dataclass(frozen=True)
class Mistake:
    """What may have gone wrong, and how everything would be without it.

    Attributes:
        text: behind "if".
        measurements: without the mistake.
        arm: without the mistake; None where it is not in the arm's tool.
    """

    text: str
    measurements: Measurements
    arm: SerialArm | None = None


def single_mistakes(arm: SerialArm, rows: Measurements) -> Iterator[Mistake]:
    """Give each mistake by itself."""
    joints = rows.commands.joints
    for text, turned in in_radians(arm, joints, rows.names):
        yield Mistake(text, moved(arm, rows, turned))
    if may_be_radians(joints):
        both = scaled(moved(arm, rows, np.rad2deg(joints)), 1000.0)
        yield Mistake("the joints are in rad and the coordinates in m", both)
    yield from _mixed_lengths(rows)
    for unit, mm in LENGTHS_MM.items():
        yield Mistake(f"the coordinates are in {unit}, not in mm", scaled(rows, mm))
        yield Mistake(
            f"the places of the tool's targets are in {unit}, not in mm", rows, _tool_scaled(arm, mm)
        )
    if len(rows.points.pose):
        yield Mistake("the frame of the instrument is left-handed", mirrored(rows))
    for text, others in misplaced(arm, joints):
        yield Mistake(text, moved(arm, rows, others))
    yield from renamed(arm, rows)
    yield from _without_wrong(arm, rows)


def _without_wrong(arm: SerialArm, rows: Measurements) -> Iterator[Mistake]:
    """Leave out the pose that is missed most, again and again, while few are gone."""
    numbers = np.unique(rows.points.pose)
    kept = np.ones(len(rows.commands), dtype=np.bool_)
    for _ in range(int(_FEW_WRONG * len(numbers))):
        found = _missed_mm(arm, rows.at(kept))
        if found is None:
            return
        kept[max(found, key=lambda pose: found[pose])] = False
        if fits(arm, misfit_mm(arm, rows.at(kept))):
            left_out = ", ".join(repr(rows.names[k]) for k in np.flatnonzero(~kept))
            yield Mistake(f"{left_out} {'is' if (~kept).sum() == 1 else 'are'} left out", rows.at(kept))
            return


def _missed_mm(arm: SerialArm, rows: Measurements) -> dict[int, float] | None:
    """Return by how much the nominal arm misses the places of each pose; None where nothing is found from them."""
    residuals = residuals_mm(*places_only(arm, rows))
    if residuals is None:
        return None
    sizes = np.linalg.norm(residuals[: 3 * len(rows.points.pose)].reshape(-1, 3), axis=1)
    found: dict[int, float] = {}
    for pose, size in zip(rows.points.pose.tolist(), sizes.tolist(), strict=True):
        found[pose] = max(size, found.get(pose, 0.0))
    return found


def _mixed_lengths(rows: Measurements) -> Iterator[Mistake]:
    """Give the rows whose places are in m while the others are in mm."""
    places = rows.points.place_mm
    if not len(places):
        return
    away = np.linalg.norm(places, axis=1)
    small = away < _SMALL_SHARE * np.median(away)
    if small.any():
        first = rows.names[rows.points.pose[int(np.argmax(small))]]
        scaled = np.where(small[:, None], 1000.0, 1.0) * places
        yield Mistake(
            f"the places of {np.count_nonzero(small)} rows are in m, not in mm (the first: pose {first!r})",
            replace(rows, points=replace(rows.points, place_mm=scaled)),
        )


def renamed(arm: SerialArm, rows: Measurements) -> Iterator[Mistake]:
    """Give each exchange of the targets' names; none where there are too many."""
    used = rows.targets
    if not 1 < len(used) <= _MOST_TARGETS:
        return
    for order in permutations(used):
        if order == used:
            continue
        to = np.arange(len(arm.targets))
        to[list(used)] = order
        swapped = ", ".join(
            f"{arm.targets[a].name} is {arm.targets[b].name}"
            for a, b in zip(used, order, strict=True)
            if a != b
        )
        yield Mistake(
            f"the names of the targets are mixed up ({swapped})",
            replace(
                rows,
                points=replace(rows.points, target=to[rows.points.target]),
                distances=replace(rows.distances, target=to[rows.distances.target]),
            ),
        )


def moved(arm: SerialArm, rows: Measurements, joints: Floats) -> Measurements:
    """Return measurements with other joints at their poses, deg or mm, shape (n, joints)."""
    return replace(rows, commands=Commands.of(arm, joints, rows.commands.approach))


def _tool_scaled(arm: SerialArm, factor: float) -> SerialArm:
    def place(one: Point) -> Point:
        x, y, z = one
        return factor * x, factor * y, factor * z

    return replace(arm, targets=tuple(replace(one, place_mm=place(one.place_mm)) for one in arm.targets))


def scaled(rows: Measurements, factor: float) -> Measurements:
    """Return measurements with longer places and distances."""
    points = replace(rows.points, place_mm=factor * rows.points.place_mm)
    distances = replace(rows.distances, distance_mm=factor * rows.distances.distance_mm)
    return replace(rows, points=points, distances=distances)


def mirrored(rows: Measurements) -> Measurements:
    """Return measurements with places in a frame of the other hand."""
    mirror = np.array([1.0, 1.0, -1.0])
    return replace(rows, points=replace(rows.points, place_mm=mirror * rows.points.place_mm))
