"""One joint turned by itself before the instrument: where, over which range, and in which order."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from catseye.drivers.roles.pose import Pose, out_of_range, with_axis
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.motion.clear_way import clear_poses, way_refusal
from catseye.procedures.serial_arm.bench import SerialBench, ToolTarget
from catseye.procedures.serial_arm.sight import best_seen, sight_deg

Floats = NDArray[np.float64]

FEWEST: Final = 7
"""Places of a turn: a circle in space needs five."""

_STEP_DEG: Final = 5.0
_REACH_DEG: Final = 60.0
"""To either side, for frames."""

_AT_ONCE: Final = 4096
"""Places that are looked at together: memory stays bounded with the smallest steps."""

_TRIED: Final = 60
"""Ways of standing among which the one is chosen from which both joints turn farthest in sight."""


@dataclass(frozen=True)
class Turn:
    """A joint that turns by itself.

    Attributes:
        joint: its number, from 1.
        name: of the axis.
        target: that is measured.
        standing: pose of the others; this joint's value counts for nothing.
        values_deg: where it is measured, upwards.
        approach_deg: by which it goes beyond the ends, so that every place is come to from one side.
        both_ways: it is measured on the way back, too.
    """

    joint: int
    name: str
    target: str
    standing: Pose
    values_deg: tuple[float, ...]
    approach_deg: float
    both_ways: bool

    def pose(self, value_deg: float) -> Pose:
        """Return the pose with the joint at a value."""
        return with_axis(self.standing, self.joint - 1, value_deg)

    @property
    def order(self) -> tuple[tuple[float, bool], ...]:
        """Values with whether they are reached from below."""
        up = tuple((value, True) for value in self.values_deg)
        return (*up, *((value, False) for value, _ in reversed(up))) if self.both_ways else up

    @property
    def first(self) -> Pose:
        """Where the first place is come to from."""
        return self.pose(self.values_deg[0] - self.approach_deg)

    @property
    def turning_back(self) -> Pose:
        """Where the way back begins."""
        return self.pose(self.values_deg[-1] + self.approach_deg)

    @property
    def way(self) -> tuple[Pose, ...]:
        """Every pose that is driven to, in order."""
        up = tuple(map(self.pose, self.values_deg))
        return (self.first, *up, self.turning_back, *reversed(up)) if self.both_ways else (self.first, *up)


@dataclass(frozen=True)
class FramesPlan:
    """Base and flange from two axes each.

    Attributes:
        base: turns of the first joint and of the next that crosses it.
        flange: turns of the last joint and of the one before that crosses it.
    """

    base: tuple[Turn, Turn]
    flange: tuple[Turn, Turn]

    @property
    def turns(self) -> tuple[Turn, ...]:
        """All turns in order."""
        return (*self.base, *self.flange)


def plan_frames(
    bench: SerialBench, poses: Floats, targets: tuple[ToolTarget, ...], rest: Pose, approach_deg: float
) -> FramesPlan:
    """Return the turns that show base and flange.

    Args:
        poses: at which targets are seen and the arm stands clear, shape (n, axes).
        rest: from where the arm comes.
        approach_deg: by which each joint comes from below.

    Raises:
        PlanError: nowhere two axes turn far enough in sight.
    """
    last = len(bench.arm.axes)
    return FramesPlan(
        _pair(bench, poses, targets, (1, 2), rest, approach_deg),
        _pair(bench, poses, targets, (last, last - 1), rest, approach_deg),
    )


def _pair(
    bench: SerialBench,
    poses: Floats,
    targets: tuple[ToolTarget, ...],
    joints: tuple[int, int],
    rest: Pose,
    approach_deg: float,
) -> tuple[Turn, Turn]:
    best: tuple[Turn, Turn] | None = None
    tried = poses[:_TRIED]
    looking = best_seen(bench, tried, targets)
    standing = [tuple(pose) for pose in tried.tolist()]
    turns = (
        turns_over(bench, standing, joint, targets, _STEP_DEG, _REACH_DEG, approach_deg) for joint in joints
    )
    for ones, others, number in zip(*turns, looking.tolist(), strict=True):
        one, other = ones[number], others[number]
        size = min(len(one.values_deg), len(other.values_deg))
        longer = size >= FEWEST and (best is None or size > min(len(turn.values_deg) for turn in best))
        if longer and drivable(bench, one, rest) and drivable(bench, other, rest):
            best = (one, other)
    if best is None:
        names = " and ".join(bench.arm.axes[joint - 1].name for joint in joints)
        raise PlanError(
            f"nowhere {names} turn over {(FEWEST - 1) * _STEP_DEG:g} deg in sight of the instrument, "
            "so frames cannot "
            "be found by turning axes: turn the nests, or leave it out (frames=false) and trust base_mm and base_deg"
        )
    return best


def drivable(bench: SerialBench, turn: Turn, rest: Pose) -> bool:
    """Return whether the arm can go from the rest pose through a turn and back, within limits and clear."""
    if any(out_of_range(bench.arm.axes, pose) for pose in turn.way):
        return False
    return way_refusal((rest, *turn.way, rest), bench) is None


def turns_over(
    bench: SerialBench,
    standing: Sequence[Pose],
    joint: int,
    targets: tuple[ToolTarget, ...],
    step_deg: float,
    reach_deg: float,
    approach_deg: float,
    *,
    both_ways: bool = False,
) -> Iterator[tuple[Turn, ...]]:
    """Yield turns over as much of the range around each pose as the instrument sees without a gap, one a target.

    Args:
        reach_deg: to either side of the pose, at most.
        approach_deg: that has to be left within the limits at the ends.
    """
    axis, count = bench.arm.axes[joint - 1], int(reach_deg // step_deg)
    offsets = step_deg * np.arange(-count, count + 1)
    above = approach_deg if both_ways else 0.0
    at_once = max(1, _AT_ONCE // len(offsets))
    for first in range(0, len(standing), at_once):
        block = standing[first : first + at_once]
        poses = np.repeat(np.array(block), len(offsets), axis=0)
        poses[:, joint - 1] += np.tile(offsets, len(block))
        values = poses[:, joint - 1]
        fits = (values >= axis.low + approach_deg - 1e-9) & (values <= axis.high - above + 1e-9)
        fits[fits] = clear_poses(poses[fits], bench)
        good = np.zeros((len(targets), len(poses)), dtype=np.bool_)
        good[:, fits] = np.isfinite(sight_deg(bench, poses[fits], targets))
        along = good.reshape(len(targets), len(block), -1)
        for number, pose in enumerate(block):
            own = values[number * len(offsets) :][: len(offsets)]
            kept = [own[_around(one, count)].tolist() for one in along[:, number]]
            yield tuple(
                Turn(joint, axis.name, target.name, pose, tuple(seen_deg), approach_deg, both_ways)
                for target, seen_deg in zip(targets, kept, strict=True)
            )


def _around(good: NDArray[np.bool_], middle: int) -> slice:
    """Return the run of good places around one, empty where that is not good."""
    if not good[middle]:
        return slice(middle, middle)
    bad = np.flatnonzero(~good)
    below, above = bad[bad < middle], bad[bad > middle]
    return slice(int(below[-1]) + 1 if len(below) else 0, int(above[0]) if len(above) else len(good))
