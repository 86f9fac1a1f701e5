"""Tables that do not belong into one: places in different frames, dead paths of which only the names are the same."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.types import Ints
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.measurements import MeasuredDistances, MeasuredOrientations, Measurements
from catseye.calibration.serial_arm.misfit import fits, misfit_mm

_FAR_BETTER = 0.2
"""Share of the misfit that is left when the tables are taken apart."""

_FEWEST = 10
"""Places of a table: fewer lie well in any frame."""

_FEWEST_POSES = 5
"""Poses of a table: a base of its own takes up what an arm misses fewer by, however many targets they have."""


@dataclass(frozen=True)
class Tables:
    """From which table each row is.

    Attributes:
        points: number of the table of each, shape (n,).
        distances: likewise, shape (m,).
    """

    points: Ints
    distances: Ints


def mistake_between(arm: SerialArm, rows: Measurements, tables: Tables) -> str | None:
    """Return what keeps tables apart that fit the arm one by one; None where nothing does."""
    return _other_frames(arm, rows, tables.points) or _other_dead_paths(arm, rows, tables.distances)


def _other_frames(arm: SerialArm, rows: Measurements, table: Ints) -> str | None:
    numbers, counts = np.unique(table, return_counts=True)
    if len(numbers) < 2 or counts.min() < _FEWEST:
        return None
    joints = rows.commands.joints[rows.points.pose]
    if min(len(np.unique(joints[table == number], axis=0)) for number in numbers) < _FEWEST_POSES:
        return None
    places = replace(rows, orientations=MeasuredOrientations(), distances=MeasuredDistances())
    misfit = misfit_mm(arm, places)
    alone = [replace(places, points=places.points.some(table == number)) for number in numbers]
    left = max(misfit_mm(arm, one) for one in alone)
    if not fits(arm, left) or left >= _FAR_BETTER * misfit:
        return None
    return (
        f"the nominal arm misses the places of all tables by {misfit:.3g} mm rms, and by {left:.3g} mm at most in "
        f"each by itself: the tables are in different frames (those of {_first_poses(alone)}). Calibrate from "
        "each by itself, or bring them into one frame by nests that all instruments measure"
    )


def _first_poses(tables: Sequence[Measurements]) -> str:
    return ", ".join(f"pose {one.names[one.points.pose[0]]!r}" for one in tables)


def _other_dead_paths(arm: SerialArm, rows: Measurements, table: Ints) -> str | None:
    """Return which dead path is not the same in all tables that have a segment of its name."""
    distances = rows.distances
    pairs = np.unique(np.column_stack([distances.segment, table])[distances.segment >= 0], axis=0)
    names, counts = np.unique(pairs[:, 0], return_counts=True)
    if not (counts > 1).any():
        return None
    own = {pair: number for number, pair in enumerate(map(tuple, pairs.tolist()))}
    apart = [own.get(pair, -1) for pair in zip(distances.segment.tolist(), table.tolist(), strict=True)]
    split = replace(
        rows,
        distances=replace(distances, segment=np.array(apart), segments=tuple(map(str, own))),
    )
    misfit, left = misfit_mm(arm, rows), misfit_mm(arm, split)
    if not fits(arm, left) or left >= _FAR_BETTER * misfit:
        return None
    return (
        f"the nominal arm misses the measurements by {misfit:.3g} mm rms, and by {left:.3g} mm if each table has "
        f"dead paths of its own: {distances.segments[int(names[counts > 1][0])]} is a segment of several tables, and "
        "the counter was zeroed between them. Give each start of the counter its own name in the column segment"
    )
