"""The bodies of an arm and what stands around it, and how far they are from each other at a pose.

Bodies of an arm are capsules on the frames of its joints. Those of one frame are not compared, nor are those of
neighbouring frames that both reach the axis of the joint between them: they meet there by design.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.distances import depth_in_box_mm, segment_to_box_mm, segment_to_segment_mm
from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.types import Floats

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Capsule:
    """A segment with a radius, fixed to a frame.

    Attributes:
        name: as messages use it.
        frame: number of the frame, 0 for the base.
        start_mm: one end of the segment in that frame.
        end_mm: the other end.
    """

    name: str
    frame: int
    start_mm: Point
    end_mm: Point
    radius_mm: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.radius_mm < math.inf:
            raise KinematicsError(
                f"body {self.name}: its radius is {self.radius_mm:g} mm: state zero or more"
            )
        if not all(map(math.isfinite, (*self.start_mm, *self.end_mm))):
            raise KinematicsError(f"body {self.name}: an end is not finite: state x, y and z in mm")


@dataclass(frozen=True)
class Box:
    """A box along the axes of the base's frame.

    Attributes:
        name: as messages use it.
        low_mm: smallest x, y, z.
        high_mm: largest x, y, z.
    """

    name: str
    low_mm: Point
    high_mm: Point

    def __post_init__(self) -> None:
        if not all(low <= high for low, high in zip(self.low_mm, self.high_mm, strict=True)):
            raise KinematicsError(f"box {self.name}: its smallest corner exceeds its largest: exchange them")


@dataclass(frozen=True)
class Table:
    """What lies below a height, everywhere.

    Attributes:
        name: as messages use it.
        z_mm: its height in the base's frame.
    """

    name: str
    z_mm: float

    def __post_init__(self) -> None:
        if not math.isfinite(self.z_mm):
            raise KinematicsError(f"{self.name}: its height is not finite: state it in mm")


@dataclass(frozen=True)
class Scene:
    """An arm and its surroundings.

    Attributes:
        chain: the arm's joints.
        arm: its bodies; those of frame 0 do not move.
        stands: bodies around it, of frame 0.
        table: below everything; None without one.
        keep_out: no moving body may enter one.
        keep_in: no moving body may leave any.
    """

    chain: Chain
    arm: tuple[Capsule, ...]
    stands: tuple[Capsule, ...] = ()
    table: Table | None = None
    keep_out: tuple[Box, ...] = ()
    keep_in: tuple[Box, ...] = ()


Pair = tuple[str, str]
"""Names of two bodies, a moving one first."""

_LONG_MM = 1e5
"""Half of what stands for an axis without end."""


class Gaps:
    """Distances of all pairs of bodies that may meet.

    Attributes:
        pairs: names of the bodies, in the order of the distances.
        levers: upper bound of how much the distance of a pair changes with each joint, mm per deg or mm, shape
            (pairs, joints).
    """

    def __init__(self, scene: Scene) -> None:
        capsules = (*scene.arm, *scene.stands)
        moving = [i for i, body in enumerate(scene.arm) if body.frame > 0]
        meeting = [
            (far, near)
            for near, far in (sorted(two, key=lambda i: scene.arm[i].frame) for two in _two_of(scene.arm))
            if _may_meet(scene.chain, scene.arm[near], scene.arm[far])
        ]
        meeting += [(i, len(scene.arm) + k) for i in moving for k in range(len(scene.stands))]
        self._chain = scene.chain
        self._frame = np.array([body.frame for body in capsules], dtype=np.int64)
        ends = np.array([[body.start_mm, body.end_mm] for body in capsules]).reshape(-1, 2, 3)
        self._ends = np.concatenate([ends, np.ones((len(capsules), 2, 1))], axis=-1).transpose(0, 2, 1)
        self._radius = np.array([body.radius_mm for body in capsules])
        self._moving = np.array(moving, dtype=np.int64)
        self._one, self._other = np.array(meeting, dtype=np.int64).reshape(-1, 2).T
        self._table = scene.table
        self._out, self._in = _bounds(scene.keep_out), _bounds(scene.keep_in)
        self.pairs: list[Pair] = [(capsules[i].name, capsules[k].name) for i, k in meeting]
        tables = () if scene.table is None else (scene.table,)
        around = (*tables, *scene.keep_out, *scene.keep_in)
        self.pairs += [(capsules[i].name, other.name) for other in around for i in moving]
        bases = [(i, capsules[k].frame) for i, k in meeting] + [(i, 0) for _ in around for i in moving]
        self.levers = np.array([self._levers(capsules[i], base) for i, base in bases])
        self.levers = self.levers.reshape(-1, len(scene.chain.joints))

    def at(self, poses: Floats) -> Floats:
        """Return the distances of all pairs at poses.

        Args:
            poses: joints, deg or mm, shape (n, joints).

        Returns:
            mm, negative where bodies overlap, shape (pairs, n).
        """
        frames = self._chain.frames(poses)[self._frame]
        placed = frames[..., :3, :] @ self._ends[:, None]
        start, end = placed[..., 0], placed[..., 1]
        found = [self._between_capsules(start, end)]
        start, end = start[self._moving], end[self._moving]
        radius = self._radius[self._moving, None]
        if self._table is not None:
            found.append(np.minimum(start[..., 2], end[..., 2]) - self._table.z_mm - radius)
        found += [segment_to_box_mm(start, end, low, high) - radius for low, high in self._out]
        found += [depth_in_box_mm(start, end, low, high) - radius for low, high in self._in]
        return np.concatenate(found)

    def _between_capsules(self, start: Floats, end: Floats) -> Floats:
        one, other = self._one, self._other
        apart = segment_to_segment_mm(start[one], end[one], start[other], end[other])
        gaps: Floats = apart - (self._radius[one] + self._radius[other])[:, None]
        return gaps

    def _levers(self, body: Capsule, base: int) -> list[float]:
        """Return how far the joints between two frames move a body as seen from the nearer frame."""
        ends = (body.start_mm, body.end_mm)
        return [
            max(self._chain.lever(joint, body.frame, end) for end in ends)
            if base < joint <= body.frame
            else 0.0
            for joint in range(1, len(self._chain.joints) + 1)
        ]


def outermost_levers(chain: Chain, arm: Sequence[Capsule]) -> Floats:
    """Return upper bounds of how far any point of an arm's bodies moves when one joint moves by one unit.

    Returns:
        mm per deg of a revolute joint, 1 for a prismatic one, shape (joints,).
    """
    return np.array([_farthest(chain, arm, joint) for joint in range(1, len(chain.joints) + 1)])


def _farthest(chain: Chain, arm: Sequence[Capsule], joint: int) -> float:
    beyond_mm = math.radians(1.0) if chain.joints[joint - 1].kind == "revolute" else 0.0
    return max(
        (
            chain.lever(joint, body.frame, end) + beyond_mm * body.radius_mm
            for body in arm
            if body.frame >= joint
            for end in (body.start_mm, body.end_mm)
        ),
        default=0.0,
    )


def _may_meet(chain: Chain, near: Capsule, far: Capsule) -> bool:
    """Return whether two bodies are compared, the one nearer to the base first."""
    apart = far.frame - near.frame
    return apart > 1 or (
        apart == 1 and not all(_reaches_axis(chain, body, far.frame) for body in (near, far))
    )


def _reaches_axis(chain: Chain, body: Capsule, joint: int) -> bool:
    """Return whether a body, fixed to the frame of a joint or of the one before it, touches the joint's axis.

    The axis is fixed to both frames, so any pose shows it.
    """
    frames = chain.frames(np.zeros((1, len(chain.joints))))[:, 0]
    (start, end), (low, high) = (
        np.array([[*point, 1.0] for point in points]) @ frames[frame, :3].T
        for frame, points in (
            (body.frame, (body.start_mm, body.end_mm)),
            (joint, ((0.0, 0.0, -_LONG_MM), (0.0, 0.0, _LONG_MM))),
        )
    )
    return bool(segment_to_segment_mm(start, end, low, high) <= body.radius_mm)


def _two_of(arm: tuple[Capsule, ...]) -> list[tuple[int, int]]:
    return list(combinations(range(len(arm)), 2))


def _bounds(boxes: tuple[Box, ...]) -> list[tuple[Floats, Floats]]:
    return [(np.array(box.low_mm), np.array(box.high_mm)) for box in boxes]
