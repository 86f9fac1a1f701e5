"""A path on a sphere about a fixed cup by commands of a calibrated arm, and the lengths that a bar has there."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.kinematics.inverse import inverse_kinematics
from catseye.calibration.kinematics.rotations import rotation_of
from catseye.calibration.serial_arm.compensation import compensate
from catseye.calibration.serial_arm.geometry import Commands, Geometry
from catseye.drivers.roles.pose import Axes, Pose, out_of_range
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.motion.clear_way import clear_poses
from catseye.procedures.serial_arm.bench import SerialBench, ToolTarget

Floats = NDArray[np.float64]

_FINE_DEG: Final = 2.5
"""Between two commands on the sphere: the chord of the joints lies 0.07 mm inside at a radius of 300 mm."""

_FIRST_ROLLS: Final = np.arange(0.0, 360.0, 15.0)
_NEXT_ROLLS: Final = np.arange(-8.0, 8.1, 2.0)
"""Turns of the tool about the bar that are tried, deg."""

_TILTS: Final = ((0.0, 0.0), *((tilt, side) for tilt in (20.0, 40.0) for side in np.arange(0.0, 360.0, 45.0)))
"""Angles between the nest's normal and the bar, and to which side, deg: a magnetic cup holds the ball beyond."""

_MOST_STARTS: Final = 60
_ROOM_DEG: Final = 1.0
"""Of each range at either end, deg: compensated commands differ by less from those of the nominal arm."""

_MOST_TURN_DEG: Final = 20.0
"""Of a joint between two commands: more is another way to stand there."""

_STAYS_DEG: Final = 1e-6
"""A change of a joint below this is rounding, no motion."""

_STRAY_MM: Final = 0.1
"""Between two commands; where the bar would stray farther, the path gets another place in the middle."""

_MOST_HALVINGS: Final = 4

_INSIDE: Final = 4
"""Places between two commands at which the length is looked at."""


@dataclass(frozen=True)
class SpherePoint:
    """A place on the sphere.

    Attributes:
        azimuth_deg: of the bar about the base's z, seen from the cup; 0 is `towards_deg`.
        elevation_deg: above the horizontal plane.
        measured: it is no mere place on the way.
        towards_deg: direction about the base's z from which the azimuth counts.
    """

    azimuth_deg: float
    elevation_deg: float
    measured: bool
    towards_deg: float

    @property
    def direction(self) -> Floats:
        """From the cup to the nest, in the frame of the base, shape (3,)."""
        azimuth, elevation = np.deg2rad((self.azimuth_deg + self.towards_deg, self.elevation_deg))
        return np.array(
            [
                np.cos(elevation) * np.cos(azimuth),
                np.cos(elevation) * np.sin(azimuth),
                np.sin(elevation),
            ]
        )


def sphere_path(
    azimuths_deg: Sequence[float], elevations_deg: Sequence[float], towards_deg: float
) -> list[SpherePoint]:
    """Return a path over rings, each in the other sense than the one below, with places between the measured ones."""
    corners = [
        (azimuth, elevation)
        for ring, elevation in enumerate(elevations_deg)
        for azimuth in (azimuths_deg if ring % 2 == 0 else list(azimuths_deg)[::-1])
    ]
    found = [SpherePoint(*corners[0], measured=True, towards_deg=towards_deg)]
    for before, after in pairwise(corners):
        parts = max(int(np.ceil(np.abs(np.subtract(after, before)).max() / _FINE_DEG)), 1)
        for part in range(1, parts + 1):
            at = np.add(before, np.subtract(after, before) * part / parts)
            found.append(
                SpherePoint(float(at[0]), float(at[1]), measured=part == parts, towards_deg=towards_deg)
            )
    return found


def nominal_path(
    bench: SerialBench,
    nest: ToolTarget,
    centre_mm: Floats,
    length_mm: float,
    path: Sequence[SpherePoint],
    rest: Pose,
) -> Floats:
    """Return the joints of the nominal arm that hold a nest on the sphere, looking at the cup, shape (n, joints).

    Args:
        nest: where it is taken to be on the flange; commands are compensated for the same place.

    Raises:
        PlanError: the nest has no normal, or the arm cannot go along the path.
    """
    if nest.normal is None:
        raise PlanError(
            f"the target {nest.name} has no normal: state in the tool file the direction in which the nest opens"
        )
    solver = _Solver(bench, nest, centre_mm, length_mm)
    farthest = path[0]
    for start, held in solver.starts(path[0], rest)[:_MOST_STARTS]:
        found, stuck = solver.along(path, start, held)
        if stuck is None:
            return np.array(found)
        farthest = max(farthest, stuck, key=lambda one: list(path).index(one))
    raise PlanError(
        f"{nest.name}: the arm cannot hold the nest on the sphere at azimuth {farthest.azimuth_deg:g} "
        "deg, elevation "
        f"{farthest.elevation_deg:g} deg: choose smaller ranges of azimuth and elevation, or place "
        "the cup elsewhere "
        "(centre_mm in [ballbar])"
    )


@dataclass(frozen=True)
class _Held:
    """How a nest is held.

    Attributes:
        roll_deg: of the tool about the bar.
        tilt_deg: of the nest's normal against the bar.
        side_deg: to which side.
    """

    roll_deg: float
    tilt_deg: float
    side_deg: float


@dataclass(frozen=True)
class _Solver:
    bench: SerialBench
    nest: ToolTarget
    centre_mm: Floats
    length_mm: float

    def starts(self, first: SpherePoint, rest: Pose) -> list[tuple[Pose, _Held]]:
        """Return ways to stand at the first place and hold the nest, the nearest to the rest pose first."""
        held = [_Held(float(roll), tilt, float(side)) for tilt, side in _TILTS for roll in _FIRST_ROLLS]
        found = self._solved(first, np.array(rest), held)
        return sorted(found, key=lambda one: (one[1].tilt_deg, _apart(one[0], rest)))

    def along(
        self, path: Sequence[SpherePoint], start: Pose, held: _Held
    ) -> tuple[list[Pose], SpherePoint | None]:
        """Return the joints along a path, and the place that cannot be reached; None where all can."""
        poses = [start]
        for point in path[1:]:
            rolled = [replace(held, roll_deg=held.roll_deg + float(by)) for by in _NEXT_ROLLS]
            near = self._solved(point, np.array(poses[-1]), rolled)
            near = [one for one in near if _apart(one[0], poses[-1]) <= _MOST_TURN_DEG]
            if not near:
                return poses, point
            pose, held = min(near, key=lambda one: _apart(one[0], poses[-1]))
            poses.append(pose)
        return poses, None

    def _solved(
        self, point: SpherePoint, reference: Floats, held: Sequence[_Held]
    ) -> list[tuple[Pose, _Held]]:
        tool = np.eye(4)
        tool[:3, 3] = self.nest.place_mm
        inverse = inverse_kinematics(self.bench.workspace.chain, self._frames(point, held), reference, tool)
        refused = {one.row for one in inverse.refused}
        good = np.array([row not in refused for row in range(len(held))])
        poses = np.where(good[:, None], inverse.poses, 0.0)
        good &= clear_poses(poses, self.bench)
        listed = [tuple(pose) for pose in poses.tolist()]
        return [
            (listed[row], held[row])
            for row in np.flatnonzero(good).tolist()
            if not out_of_range(self._axes, listed[row])
        ]

    @cached_property
    def _axes(self) -> Axes:
        """The axes, with room for the compensation at the ends of their ranges."""
        return tuple(
            replace(axis, low=axis.low + _ROOM_DEG, high=axis.high - _ROOM_DEG)
            for axis in self.bench.arm.axes
        )

    def _frames(self, point: SpherePoint, held: Sequence[_Held]) -> Floats:
        """Return the nest's frames, turned like the flange, shape (n, 4, 4).

        Its normal looks at the cup, but for the tilt.
        """
        turns = [
            ((0.0, 0.0, one.side_deg), (one.tilt_deg, 0.0, 0.0), (0.0, 0.0, one.roll_deg)) for one in held
        ]
        aside, tilted, roll = rotation_of(np.array(turns)).swapaxes(0, 1)
        tilt = aside @ tilted @ aside.swapaxes(-1, -2)
        made = np.tile(np.eye(4), (len(held), 1, 1))
        made[:, :3, :3] = _across(-point.direction) @ roll @ tilt @ self._looks.T
        made[:, :3, 3] = self.centre_mm + self.length_mm * point.direction
        return made

    @cached_property
    def _looks(self) -> Floats:
        """A rotation whose third column is the nest's normal."""
        return _across(np.array(self.nest.normal) / np.linalg.norm(np.array(self.nest.normal)))


def _apart(one: Pose, other: Pose) -> float:
    return float(np.abs(np.subtract(one, other)).max())


def _across(axis: Floats) -> Floats:
    """Return a rotation whose third column is an axis; the others follow it steadily."""
    aside = np.array([1.0, 0.0, 0.0]) if abs(axis[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    first = aside - (aside @ axis) * axis
    first = first / np.linalg.norm(first)
    return np.column_stack([first, np.cross(axis, first), axis])


@dataclass(frozen=True)
class PredictedPath:
    """Commands of a calibrated arm along a path.

    Attributes:
        commands: shape (n, joints).
        deviation_mm: of the bar from its nominal length at each command, shape (n,).
        between_mm: its largest deviation between each command and the next, shape (n - 1,).
    """

    commands: Floats
    deviation_mm: Floats
    between_mm: Floats

    @property
    def largest_mm(self) -> float:
        """The largest deviation at the commands and between them."""
        return float(np.abs(np.concatenate([self.deviation_mm, self.between_mm])).max())


def compensated_path(
    geometry: Geometry, nest: int, centre_mm: Floats, length_mm: float, nominal: Floats, rest: Pose
) -> PredictedPath:
    """Return the commands that bring the calibrated arm onto the sphere, and the lengths that they lead to.

    Nothing takes the play of the joints up on the way: each comes to a place from where it was before.

    Args:
        geometry: of the calibrated arm.
        nest: number of the target.
        centre_mm: of the cup in the frame of the base.
        nominal: joints of the nominal arm on the sphere, shape (n, joints).
        rest: joints that the path is entered from.

    Raises:
        PlanError: the calibrated arm does not reach a place.
    """
    tool = np.eye(4)
    tool[:3, 3] = geometry.tools[nest, :3, 3]
    sides = _sides(nominal, rest)
    found = compensate(geometry, nominal, tool, sides)
    if found.refused:
        first = found.refused[0]
        raise PlanError(
            f"place {first.row + 1} of the path cannot be reached by the calibrated arm: "
            f"{first.reason}; choose smaller "
            "ranges of azimuth and elevation"
        )
    shares = np.arange(1, _INSIDE + 1) / (_INSIDE + 1)
    between = found.joints[:-1, None] + shares[:, None] * np.diff(found.joints, axis=0)[:, None]
    at = lengths_mm(geometry, nest, centre_mm, found.joints, sides) - length_mm
    inside = (
        lengths_mm(
            geometry,
            nest,
            centre_mm,
            between.reshape(-1, nominal.shape[1]),
            np.repeat(sides[1:], _INSIDE, axis=0),
        )
        - length_mm
    )
    return PredictedPath(found.joints, at, np.abs(inside).reshape(-1, _INSIDE).max(axis=1))


def _sides(joints: Floats, rest: Pose) -> Floats:
    """Return the side that each joint comes from, 1 from below, −1 from above, shape (n, joints).

    A joint that stays keeps its side; one that has not moved yet counts as come from below.
    """
    steps = np.diff(np.vstack([np.array(rest), joints]), axis=0)
    sides, last = np.ones_like(joints), np.ones(joints.shape[1])
    for k, step in enumerate(steps):
        last = np.where(np.abs(step) > _STAYS_DEG, np.sign(step), last)
        sides[k] = last
    return sides


def refined_path(
    path: Sequence[SpherePoint], predicted: Callable[[Sequence[SpherePoint]], PredictedPath]
) -> tuple[list[SpherePoint], PredictedPath]:
    """Return a path with more places where straight moves of the joints would leave the sphere, as predicted.

    Near a stretched or a singular arm the joints turn by far more than the bar does from place to place.

    Args:
        path: with as many places as an arm in the middle of its room needs.
        predicted: gives the commands along a path, and what the bar does there.

    Raises:
        PlanError: the arm cannot go along the path.
    """
    refined = list(path)
    found = predicted(refined)
    for _ in range(_MOST_HALVINGS):
        stray = found.between_mm > _STRAY_MM
        if not stray.any():
            break
        parts = [
            (one, _middle(one, other)) if far else (one,)
            for (one, other), far in zip(pairwise(refined), stray, strict=True)
        ]
        refined = [*(point for part in parts for point in part), refined[-1]]
        found = predicted(refined)
    return refined, found


def _middle(one: SpherePoint, other: SpherePoint) -> SpherePoint:
    return replace(
        one,
        azimuth_deg=0.5 * (one.azimuth_deg + other.azimuth_deg),
        elevation_deg=0.5 * (one.elevation_deg + other.elevation_deg),
        measured=False,
    )


def lengths_mm(
    geometry: Geometry, nest: int, centre_mm: Floats, commands: Floats, approach: Floats
) -> Floats:
    """Return how far a nest of the calibrated arm is from the cup, mm, shape (n,)."""
    return np.asarray(np.linalg.norm(places_mm(geometry, nest, commands, approach) - centre_mm, axis=1))


def places_mm(geometry: Geometry, nest: int, commands: Floats, approach: Floats | None = None) -> Floats:
    """Return where a nest of the calibrated arm is in the frame of the arm's base, mm, shape (n, 3).

    Args:
        commands: shape (n, joints).
        approach: side that each joint comes from, shape (n, joints); from below without it.
    """
    frames = geometry.frames(Commands.of(geometry.arm, commands, approach))
    seen = geometry.places_mm(frames[-1], np.full(len(commands), nest))
    return np.asarray((seen - geometry.base[:3, 3]) @ geometry.base[:3, :3])
