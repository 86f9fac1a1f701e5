"""Measured distances, as columns."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from catseye.calibration.core.arguments import (
    require_below,
    require_directions,
    require_finite,
    require_positive,
    require_shape,
)
from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Bools, Floats, Ints

_Column = TypeVar("_Column", Floats, Bools)


@dataclass(frozen=True)
class Commands:
    """Command angles with their state of approach.

    Attributes:
        theta1_rad: J1 command angles, rad, shape (n,).
        theta2_rad: J2 command angles, rad, shape (n,).
        direction1: state of approach of J1, 1 or -1, shape (n,).
        direction2: state of approach of J2, 1 or -1, shape (n,).
    """

    theta1_rad: Floats
    theta2_rad: Floats
    direction1: Ints
    direction2: Ints

    def __post_init__(self) -> None:
        for name in ("theta2_rad", "direction1", "direction2"):
            require_shape(getattr(self, name), np.shape(self.theta1_rad), name)
        require_directions(self.direction1, "direction1")
        require_directions(self.direction2, "direction2")

    def __len__(self) -> int:
        """Return the number of rows."""
        return int(self.theta1_rad.size)

    def select(self, rows: Bools | Ints) -> "Commands":
        """Return the chosen rows."""
        return Commands(
            self.theta1_rad[rows], self.theta2_rad[rows], self.direction1[rows], self.direction2[rows]
        )

    def poses(self) -> Ints:
        """Return the number of each row's pose, whatever its directions, shape (n,)."""
        angles = np.column_stack([self.theta1_rad, self.theta2_rad])
        return np.asarray(
            np.unique(np.round(angles, 9), axis=0, return_inverse=True)[1], dtype=np.int64
        ).ravel()


@dataclass(frozen=True)
class Points:
    """Distances in measuring order.

    Attributes:
        commands: where the arm was sent.
        reflector: index into reflector_names, shape (n,).
        dead_path: index into dead_paths, shape (n,).
        displacement_mm: distance relative to the zero of its segment, shape (n,).
        sigma_mm: standard uncertainty of each distance, shape (n,), or None when it is not known.
        reflector_names: names of the reflectors.
        dead_paths: (reflector name, segment) of each dead path.
        theta4_rad: angle of the beam against link 2, rad, shape (n,); None where nothing depends on it.
        elapsed: share of the measurement that had passed, −½…½, shape (n,), where these rows are a part of it; None
            where they are all, and their order is the clock.
        mount_rad: angle by which the interferometer is turned on J4's flange against its first mounting, shape (n,);
            None for 0 everywhere. J4's own angle is the beam's angle against link 2 less this.
        returned: whether the arm was sent back to a pose measured before, to see the drift, shape (n,); None where
            nobody says. Such a distance counts as any other.
    """

    commands: Commands
    reflector: Ints
    dead_path: Ints
    displacement_mm: Floats
    sigma_mm: Floats | None
    reflector_names: tuple[str, ...]
    dead_paths: tuple[tuple[str, int], ...]
    theta4_rad: Floats | None = None
    elapsed: Floats | None = None
    mount_rad: Floats | None = None
    returned: Bools | None = None

    def __post_init__(self) -> None:
        optional = ("sigma_mm", "theta4_rad", "elapsed", "mount_rad", "returned")
        for name in ("reflector", "dead_path", "displacement_mm", *optional):
            if (column := getattr(self, name)) is not None:
                require_shape(column, (len(self.commands),), name)
        require_finite(self.displacement_mm, "displacement_mm")
        require_below(self.reflector, len(self.reflector_names), "reflector")
        require_below(self.dead_path, len(self.dead_paths), "dead_path")
        if self.sigma_mm is not None:
            require_positive(self.sigma_mm, "sigma_mm")
        if self.mount_rad is not None:
            self._require_one_mount_a_segment(self.mount_rad)

    def _require_one_mount_a_segment(self, mount_rad: Floats) -> None:
        require_finite(mount_rad, "mount_rad")
        known = np.zeros(len(self.dead_paths))
        known[self.dead_path] = mount_rad
        mixed = self.dead_path[known[self.dead_path] != mount_rad]
        if mixed.size:
            raise two_mounts(self.dead_paths[int(mixed[0])])

    def __len__(self) -> int:
        """Return the number of distances."""
        return int(self.displacement_mm.size)

    @property
    def returns(self) -> int | None:
        """Number of returns among the distances; None where nobody says."""
        return None if self.returned is None else int(np.count_nonzero(self.returned))

    @property
    def weights(self) -> Floats:
        """Reciprocal standard uncertainties, 1/mm, shape (n,); ones when none are stated."""
        return np.ones(len(self)) if self.sigma_mm is None else 1.0 / self.sigma_mm

    def repeats(self, *, bidirectional: bool) -> Ints:
        """Return the number of what each distance measures, shape (n,): reflector, dead path, θ1, θ2.

        Args:
            bidirectional: distances at a pose repeat each other whatever the directions of approach.
        """
        commands = self.commands
        key = np.zeros(len(self), dtype=np.int64)
        columns = [self.reflector, self.dead_path]
        columns += [np.round(commands.theta1_rad, 9), np.round(commands.theta2_rad, 9)]
        if not bidirectional:
            columns += [commands.direction1, commands.direction2]
        for column in columns:
            values, number = np.unique(column, return_inverse=True)
            key = key * values.size + number
        return np.asarray(np.unique(key, return_inverse=True)[1], dtype=np.int64)

    @property
    def elapsed_share(self) -> Floats:
        """Share of the measurement that had passed, less a half, shape (n,): as stated or, without, by order."""
        return shares_passed(np.arange(len(self)), len(self)) if self.elapsed is None else self.elapsed

    @property
    def reversed_mountings(self) -> bool:
        """Whether the interferometer was mounted both ways round."""
        if self.mount_rad is None:
            return False
        facing = np.cos(self.mount_rad)
        return bool(facing.min() < 0.0 < facing.max())

    def rows(self, rows: Bools | Ints) -> "Points":
        """Return the chosen rows; all dead paths and reflectors keep their names and numbers."""
        return replace(
            self,
            commands=self.commands.select(rows),
            reflector=self.reflector[rows],
            dead_path=self.dead_path[rows],
            displacement_mm=self.displacement_mm[rows],
            sigma_mm=_rows_of(self.sigma_mm, rows),
            theta4_rad=_rows_of(self.theta4_rad, rows),
            elapsed=_rows_of(self.elapsed, rows),
            mount_rad=_rows_of(self.mount_rad, rows),
            returned=_rows_of(self.returned, rows),
        )

    def select(self, rows: Bools | Ints) -> "Points":
        """Return the chosen rows; dead paths and reflectors that lose all rows are left out."""
        kept = self.rows(rows)
        paths, path_index = np.unique(kept.dead_path, return_inverse=True)
        names, name_index = np.unique(kept.reflector, return_inverse=True)
        return replace(
            kept,
            dead_path=path_index.astype(np.int64),
            dead_paths=tuple(self.dead_paths[int(i)] for i in paths),
            reflector=name_index.astype(np.int64),
            reflector_names=tuple(self.reflector_names[int(i)] for i in names),
        )


def _rows_of(column: _Column | None, rows: Bools | Ints) -> _Column | None:
    return None if column is None else column[rows]


def two_mounts(dead_path: tuple[str, int]) -> ArgumentError:
    """Return the complaint about a segment (reflector name, number) with more than one mounting."""
    name, segment = dead_path
    return ArgumentError(
        f"segment {segment} of reflector {name} has more than one mount_deg: turning the interferometer on its "
        "flange interrupts the beam, so what follows is a new segment"
    )


def shares_passed(numbers: Ints, rows: int) -> Floats:
    """Return the share of a measurement that had passed at some of its rows, less a half, shape (n,).

    Rows stand for time: a night or a pause in between counts as little as any step to the next row (ADR 27).

    Args:
        numbers: which rows, from 0, shape (n,).
        rows: of the whole measurement.
    """
    return np.asarray(numbers / (rows - 1.0) - 0.5 if rows > 1 else np.zeros(numbers.shape))


FEWEST = 3
"""Distances that a segment needs to carry a dead path of its own."""


def rows_of_long_segments(points: Points) -> Bools:
    """Return which rows belong to segments that can carry a dead path of their own, shape (n,)."""
    counts = np.bincount(points.dead_path, minlength=len(points.dead_paths))
    return np.asarray((counts >= FEWEST)[points.dead_path], dtype=np.bool_)


def concatenated(parts: Sequence[Points]) -> Points:
    """Return the rows of several tables one after another; they have the names of the first."""
    commands = [part.commands for part in parts]
    return replace(
        parts[0],
        commands=Commands(
            np.concatenate([one.theta1_rad for one in commands]),
            np.concatenate([one.theta2_rad for one in commands]),
            np.concatenate([one.direction1 for one in commands]),
            np.concatenate([one.direction2 for one in commands]),
        ),
        reflector=np.concatenate([part.reflector for part in parts]),
        dead_path=np.concatenate([part.dead_path for part in parts]),
        displacement_mm=np.concatenate([part.displacement_mm for part in parts]),
        sigma_mm=_joined([part.sigma_mm for part in parts]),
        theta4_rad=_joined([part.theta4_rad for part in parts]),
        elapsed=_joined([part.elapsed for part in parts]),
        mount_rad=_mounts(parts),
        returned=_joined([part.returned for part in parts]),
    )


def _joined(columns: list[_Column | None]) -> _Column | None:
    present = [column for column in columns if column is not None]
    return np.concatenate(present) if len(present) == len(columns) else None


def _mounts(parts: Sequence[Points]) -> Floats | None:
    if all(part.mount_rad is None for part in parts):
        return None
    return np.concatenate(
        [np.zeros(len(part)) if part.mount_rad is None else part.mount_rad for part in parts]
    )


def short_segments(counts: Ints, dead_paths: Sequence[tuple[str, int]]) -> tuple[Bools, list[str]]:
    """Find segments that are too short to carry a dead path of their own.

    Args:
        counts: number of distances of each dead path, shape (k,).
        dead_paths: (reflector name, segment) of each.

    Returns:
        Flags of the short ones, shape (k,), and a sentence for each.
    """
    short = counts < FEWEST
    sentences = [
        f"segment {segment} of reflector {name} dropped: {counts[i]} distance(s), fewer than {FEWEST}"
        for i, (name, segment) in enumerate(dead_paths)
        if short[i]
    ]
    return short, sentences


def without_short_segments(points: Points) -> tuple[Points, list[str]]:
    """Drop segments that are too short to carry a dead path of their own.

    Returns:
        The remaining points and a sentence for each segment dropped.
    """
    counts = np.bincount(points.dead_path, minlength=len(points.dead_paths))
    short, sentences = short_segments(counts, points.dead_paths)
    if not sentences:
        return points, []
    return points.select(~short[points.dead_path]), sentences
