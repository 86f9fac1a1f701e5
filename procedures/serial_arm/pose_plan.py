"""Poses at which targets are measured: seen, within limits, approached from below, with free ways between them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.serial_arm.sight import straightest
from catseye.drivers.roles.pose import Pose, out_of_range
from catseye.procedures.kit.errors import PlanError, PlanLimitError
from catseye.procedures.kit.motion.clear_way import clear_poses, clear_ways, way_refusal
from catseye.procedures.kit.motion.motion_time import way_time_s
from catseye.procedures.serial_arm.axis_turns import FramesPlan
from catseye.procedures.serial_arm.bench import SerialBench, ToolTarget
from catseye.procedures.serial_arm.sight import best_seen, sight_deg

Floats = NDArray[np.float64]

Measured = Literal["points", "poses"]
"""Targets one by one by a tracker, or whole frames by an optical CMM."""

NOTHING_STATED: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType({})
"""No pose says itself which targets are measured there."""

_MOST_DRAWS = 200
"""Blocks of poses that are drawn until there are enough."""

_BLOCK = 500

_MOST_BLOCKS = 5


@dataclass(frozen=True)
class PlannedPose:
    """A pose and how it is reached.

    Attributes:
        name: as results call it.
        pose: of the arm.
        approach: where every axis comes from, at a lower value.
        free_from: pose from which the way to the approach is free, that of the pose before; from everywhere else,
            or where it is None, the way leads over the rest pose.
        targets: names of the targets that are measured there.
    """

    name: str
    pose: Pose
    approach: Pose
    free_from: Pose | None
    targets: tuple[str, ...]


@dataclass(frozen=True)
class PosePlan:
    """Everything that is measured, in order.

    Attributes:
        bench: what it was made from.
        measured: points or frames.
        rest: from where every pose can be reached over its approach.
        poses: in order.
        frames: base and tool by turning axes beforehand; None for the cell's values.
        settle_s: wait after each motion.
        dwell_s: time over which the instrument averages.
        nests_every: the fixed nests are measured again after so many poses; 0 for never.
        drift_limit_mm: motion of a nest that is warned of.
        marks: fewest marks that an optical CMM has to see of a frame, where it says how many.
        base_marks: likewise of the base, whose frame a pose is in.
    """

    bench: SerialBench
    measured: Measured
    rest: Pose
    poses: tuple[PlannedPose, ...]
    frames: FramesPlan | None
    settle_s: float
    dwell_s: float
    nests_every: int
    drift_limit_mm: float
    marks: int
    base_marks: int

    @property
    def pose_s(self) -> float:
        """Expected bench time of one pose with its share of the ways, s."""
        arm = self.bench.arm
        before = self.rest
        moving_s = 0.0
        for one in self.poses:
            moving_s += way_time_s(arm, np.array([before, *self.way_to(one, before), one.pose]))
            before = one.pose
        targets = sum(len(one.targets) for one in self.poses)
        return (moving_s + targets * (self.settle_s + self.dwell_s)) / max(len(self.poses), 1)

    def measures_nests_after(self, number: int) -> bool:
        """Return whether the nests are measured between a pose and the next, by its number from 0."""
        done = number + 1
        return bool(self.nests_every) and done % self.nests_every == 0 and done < len(self.poses)

    def way_to(self, planned: PlannedPose, before: Pose | None) -> tuple[Pose, ...]:
        """Return the poses on the way to a pose, its approach the last.

        Args:
            before: pose at which the arm stands; None where it stands nobody knows where.
        """
        if before is not None and before == planned.free_from:
            return (planned.approach,)
        back = next((one.approach for one in self.poses if one.pose == before), None)
        return (*(() if back is None else (back,)), self.rest, planned.approach)


def approach_of(pose: Pose, approach_deg: float) -> Pose:
    """Return where a pose is approached from: every axis at a lower value."""
    return tuple(value - approach_deg for value in pose)


class PoseFinder:
    """Finds poses that can be measured.

    Args:
        targets: of which at least one is seen.
        approach_deg: from below, on every axis; mm of an axis that slides.
        rest: from where poses are reached.
    """

    def __init__(
        self,
        bench: SerialBench,
        targets: tuple[ToolTarget, ...],
        measured: Measured,
        approach_deg: float,
        rest: Pose,
    ) -> None:
        self._bench = bench
        self._targets = targets
        self._as_frame = measured == "poses"
        self._approach_deg = approach_deg
        self._rest = rest

    def drawn(self, number: int, seed: int) -> Floats:
        """Return random poses at which a target is seen and the arm stands clear, shape (number, axes).

        Raises:
            PlanError: hardly any pose is.
        """
        rng = np.random.default_rng(seed)
        low, high = np.array([axis.range for axis in self._bench.arm.axes]).T
        if not (low + self._approach_deg < high).all():
            raise PlanError(
                f"an axis has a range below {self._approach_deg:g} deg: no pose can be approached "
                "from below; choose a "
                "smaller approach_deg, or widen limits_deg in the cell file"
            )
        found: list[Floats] = []
        for _ in range(_MOST_DRAWS):
            poses = rng.uniform(low + self._approach_deg, high, (_BLOCK, len(low)))
            poses = poses[self.which_seen(poses) >= 0]
            found.append(poses[self._stands_clear(poses)])
            if sum(map(len, found)) >= number:
                return np.concatenate(found)[:number]
        share = sum(map(len, found)) / (_MOST_DRAWS * _BLOCK)
        raise PlanError(
            f"of {_MOST_DRAWS * _BLOCK} random poses {share:.2%} can be measured, too few for {number}: check that "
            "base_mm and base_deg in [tracker] give the arm's place in the instrument's frame, and that the "
            "normals of the tool's targets are right; or request fewer poses"
        )

    def require_some(self, found: Sequence[Pose], blocks: int) -> None:
        """Refuse to go on drawing poses of which none can be reached.

        Raises:
            PlanError: none was found in several blocks.
        """
        if blocks >= _MOST_BLOCKS * (1 + len(found)):
            raise PlanError(
                "no pose that the instrument sees can be reached from the rest pose: choose another "
                "one (rest_deg), or "
                "correct [[body]] and [workspace] of the cell file"
            )

    def which_seen(self, poses: Floats) -> NDArray[np.int64]:
        """Return the number of the target that is seen best at each pose, −1 for none, shape (n,)."""
        return best_seen(self._bench, poses, self._targets, as_frame=self._as_frame)

    def seen_at(self, pose: Pose, most: int) -> tuple[str, ...]:
        """Return the targets that are seen at a pose, the one that looks most directly at the instrument first."""
        return self._named(self.all_seen(np.array([pose]), most)[0].tolist())

    def all_seen(self, poses: Floats, most: int) -> NDArray[np.int64]:
        """Return the numbers of the targets that are measured at each pose, −1 behind the last, shape (n, most)."""
        off = sight_deg(self._bench, poses, self._targets, as_frame=self._as_frame)
        return straightest(off, most)

    def refusal(self, pose: Pose) -> str | None:
        """Return why a pose cannot be reached from the rest pose over its approach, None when it can."""
        approach = approach_of(pose, self._approach_deg)
        wrong = [*out_of_range(self._bench.arm.axes, pose), *out_of_range(self._bench.arm.axes, approach)]
        if wrong:
            return "; ".join(dict.fromkeys(wrong))
        return way_refusal((self._rest, approach, pose), self._bench)

    def reached(self, poses: Sequence[Pose]) -> list[bool]:
        """Return which of many poses can be reached; see `refusal`."""
        axes = self._bench.arm.axes
        approaches = [approach_of(pose, self._approach_deg) for pose in poses]
        ways = [(self._rest, *way) for way in zip(approaches, poses, strict=True)]
        inside = [not any(out_of_range(axes, end) for end in way[1:]) for way in ways]
        clear = iter(clear_ways([way for way, kept in zip(ways, inside, strict=True) if kept], self._bench))
        return [kept and next(clear) for kept in inside]

    def linked(
        self,
        named: Sequence[tuple[str, Pose]],
        most: int,
        stated: Mapping[str, tuple[str, ...]] = NOTHING_STATED,
    ) -> tuple[PlannedPose, ...]:
        """Return poses with their ways; all of them can be reached from the rest pose.

        Args:
            most: targets that are measured at one pose.
            stated: targets to measure, by the name of the pose, in place of those that look best.
        """
        # All at once: each by itself takes as long as hundreds together.
        poses = [pose for _, pose in named]
        seen = self.all_seen(np.array(poses), most).tolist()
        before = [self._rest, *poses][: len(poses)]
        approaches = [approach_of(pose, self._approach_deg) for pose in poses]
        free = clear_ways(list(zip(before, approaches, strict=True)), self._bench)
        return tuple(
            PlannedPose(
                name,
                pose,
                approaches[k],
                before[k] if free[k] else None,
                stated.get(name) or self._named(seen[k]),
            )
            for k, (name, pose) in enumerate(named)
        )

    def require(
        self, named: Sequence[tuple[str, Pose]], stated: Mapping[str, tuple[str, ...]] = NOTHING_STATED
    ) -> None:
        """Refuse poses that were given and cannot be measured.

        Args:
            stated: as in `linked`.

        Raises:
            PlanLimitError: a pose or its approach lies outside the limits; it is named.
            PlanError: no target, or not each of those that are stated, is seen there, or its way is not free.
        """
        known = [one.name for one in self._targets]
        for name, pose in named:
            if (refusal := self.refusal(pose)) is not None:
                kind = PlanLimitError if "outside" in refusal else PlanError
                raise kind(
                    f"pose {name}: {refusal}: leave it out, or choose the poses again (catseye select-poses)"
                )
            seen, wanted = self.seen_at(pose, len(known)), stated.get(name, ())
            if strange := [target for target in wanted if target not in known]:
                raise PlanError(
                    f"pose {name} is to be measured at {strange[0]}, and the targets are {', '.join(known)}: correct "
                    "the column target, or name it in targets"
                )
            if hidden := [target for target in wanted if target not in seen]:
                raise PlanError(
                    f"pose {name}: the instrument does not see {hidden[0]} there: {self._why_unseen()}"
                )
            if not seen:
                raise PlanError(f"pose {name}: the instrument sees no target there: {self._why_unseen()}")

    def _why_unseen(self) -> str:
        instrument = self._bench.instrument
        limit = instrument.face_deg if self._as_frame else instrument.cone_deg
        return (
            f"it faces more than {limit:g} deg past it, or the arm stands in between; leave the pose out, turn the "
            "nests, or correct base_mm and base_deg in [tracker]"
        )

    def _stands_clear(self, poses: Floats) -> NDArray[np.bool_]:
        return clear_poses(poses, self._bench) & clear_poses(poses - self._approach_deg, self._bench)

    def _named(self, numbers: Sequence[int]) -> tuple[str, ...]:
        return tuple(self._targets[k].name for k in numbers if k >= 0)
