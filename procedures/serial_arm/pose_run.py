"""Measuring targets at poses: frames first, the fixed nests again and again, hidden targets once more at the end."""

from collections.abc import Sequence
from functools import partial
from itertools import count
from typing import Final

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.kinematics.rotations import angles_of
from catseye.drivers.roles.errors import HiddenTargetError
from catseye.drivers.roles.pose import SAME_PLACE, Pose, is_at
from catseye.drivers.roles.tracker import TargetPoint, TargetPose
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import ArmMovedError, HiddenTargetsError
from catseye.procedures.kit.motion.bench_time import BenchTime
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import numbers_of
from catseye.procedures.serial_arm.axis_turns import Turn
from catseye.procedures.serial_arm.nests import (
    coordinate_u_mm,
    drift_mm,
    have_moved,
    measure_nests,
    places_of,
)
from catseye.procedures.serial_arm.pose_plan import PlannedPose, PosePlan
from catseye.procedures.serial_arm.questions import TURN
from catseye.procedures.serial_arm.records import PLANNED, VISITS, target_record
from catseye.procedures.serial_arm.turning import Turned, frame_seen, near_mm, target_seen_mm, turned

Floats = NDArray[np.float64]

_ATTEMPTS: Final = 3
"""So often a target is measured anew when the arm was moved meanwhile."""

_LEFT_OUT: Final = 0.5
"""Share of the poses that may stay without a target."""


class PoseRun:
    """Carries a plan of poses out.

    Args:
        ctx: the bench.
        plan: what is measured.
    """

    def __init__(self, ctx: Context, plan: PosePlan) -> None:
        self._ctx = ctx
        self._plan = plan
        self._base = plan.bench.instrument.base
        self._left: Pose | None = None
        self._rounds: list[Row] = []
        self._nests_known = not ctx.resumed
        self._time = BenchTime(ctx, len(plan.poses) * plan.pose_s)

    async def run(self) -> None:
        """Measure.

        Raises:
            ArmMovedError: the arm was moved again and again while a target was measured.
            HiddenTargetsError: most targets were hidden, or those that frames come from.
        """
        await self._ctx.event(
            PLANNED,
            names=[one.name for one in self._plan.poses],
            poses=[list(one.pose) for one in self._plan.poses],
        )
        await self._frames()
        await self._nests()
        hidden: list[tuple[int, PlannedPose, Row]] = []
        for number, planned in enumerate(self._plan.poses):
            row = await self._visit(_step(VISITS[0], number), planned, planned.targets)
            hidden += [(number, planned, row)] if row["hidden"] else []
            self._time.passed(self._plan.pose_s, 0.0, f"pose {number + 1}/{len(self._plan.poses)}")
            if self._plan.measures_nests_after(number):
                await self._nests()
        left_out = await self._again(hidden)
        await self._nests()
        await self._ctx.step(
            "summary", "hidden targets, and drift of the nests", partial(self._summary, left_out)
        )

    async def _frames(self) -> None:
        frames = self._plan.frames
        if frames is None:
            return
        row = await self._ctx.step(
            "frames/base", "base by turning axes", partial(self._find_base, frames.base)
        )
        self._base = np.reshape(numbers_of(row, "base"), (4, 4))
        await self._ctx.step("frames/tool", "tool by turning axes", partial(self._find_tool, frames.flange))

    async def _find_base(self, turns: tuple[Turn, Turn]) -> Row:
        seen = await self._turned(turns)
        base = frame_seen(self._plan.bench, turns, seen)
        x_mm, y_mm, z_mm = base[:3, 3].tolist()
        rx_deg, ry_deg, rz_deg = angles_of(base[:3, :3]).tolist()
        shift = base[:3, 3] - self._plan.bench.instrument.base[:3, 3]
        turn_deg = angles_of(base[:3, :3] @ self._plan.bench.instrument.base[:3, :3].T)
        await self._ctx.event(
            "frame-found",
            frame="base",
            shift_mm=float(np.linalg.norm(shift)),
            turn_deg=float(np.linalg.norm(turn_deg)),
            x_mm=x_mm,
            y_mm=y_mm,
            z_mm=z_mm,
            rx_deg=rx_deg,
            ry_deg=ry_deg,
            rz_deg=rz_deg,
        )
        return {"base": list(base.reshape(-1).tolist()), "hidden": [*seen[0].hidden, *seen[1].hidden]}

    async def _find_tool(self, turns: tuple[Turn, Turn]) -> Row:
        seen = await self._turned(turns)
        place = target_seen_mm(self._plan.bench, turns, seen)
        stated = self._plan.bench.target(turns[0].target).place_mm
        await self._ctx.event(
            "frame-found",
            frame=turns[0].target,
            shift_mm=float(np.linalg.norm(np.subtract(place, stated))),
            x_mm=place[0],
            y_mm=place[1],
            z_mm=place[2],
        )
        return {
            "target": turns[0].target,
            "place_mm": list(place),
            "hidden": [*seen[0].hidden, *seen[1].hidden],
        }

    async def _turned(self, turns: tuple[Turn, Turn]) -> tuple[Turned, Turned]:
        """Ask, then turn both joints."""
        plan = self._plan
        if await self._ctx.ask(_turn_prompt(turns)) != "yes":
            raise HiddenTargetsError(
                f"the operator did not let {turns[0].name} and {turns[1].name} turn; continue with catseye resume, "
                "or start again with --param frames=false, which trusts base_mm and base_deg of the cell file"
            )
        found = []
        for turn in turns:
            await self._ctx.move(plan.rest)
            found.append(await turned(self._ctx, plan.bench, turn, plan.settle_s, plan.dwell_s))
        await self._ctx.move(plan.rest)
        self._left = plan.rest
        return found[0], found[1]

    async def _nests(self) -> None:
        await self._nests_as(f"nests/{len(self._rounds):02d}")

    async def _nests_anew(self, step_id: str) -> None:
        """Measure the nests before the first step after an interruption, in which the instrument may have moved."""
        before = (f"nests/resumed-{step_id.replace('/', '-')}-{attempt}" for attempt in count(1))
        for nests_id in before:
            if not self._ctx.is_done(nests_id):
                break
            await self._nests_as(nests_id)
        if not self._nests_known and not self._ctx.is_done(step_id):
            await self._nests_as(nests_id)

    async def _nests_as(self, step_id: str) -> None:
        nests = self._plan.bench.instrument.nests
        if not nests or self._plan.measured == "poses":
            return
        number = len(self._rounds)
        self._nests_known |= not self._ctx.is_done(step_id)
        action = partial(measure_nests, self._ctx, nests, number, self._plan.settle_s, self._plan.dwell_s)
        self._rounds.append(await self._ctx.step(step_id, "world frame", action))
        moved = drift_mm(self._rounds[0], self._rounds[-1])
        if not number or not moved or self._ctx.rehearsing:
            return
        name, largest = max(moved.items(), key=lambda each: each[1])
        await self._ctx.event("nests-drift", nest=name, drift_mm=largest, round=number)
        if largest > self._plan.drift_limit_mm:
            await self._ctx.warn(
                f"the nest {name} has moved by {largest:.3f} mm since the beginning, more than "
                f"{self._plan.drift_limit_mm:g} mm: check whether the instrument or the table was touched, and let "
                f"it warm up; {self._becomes_of_drift()}"
            )

    def _becomes_of_drift(self) -> str:
        """Return what the evaluation makes of the motion that the nests show now."""
        first, last = places_of(self._rounds[0]), places_of(self._rounds[-1])
        if have_moved(first, last, coordinate_u_mm(self._rounds)):
            return "the evaluation takes this motion out of the poses measured since"
        return (
            "all nests together show no motion beyond their uncertainty, so the evaluation takes none out: "
            "start again where the instrument or the table was touched"
        )

    async def _again(self, hidden: Sequence[tuple[int, PlannedPose, Row]]) -> int:
        """Measure hidden targets once more; return how many poses stay without any."""
        left_out = 0
        for number, planned, first in hidden:
            names = tuple(str(name) for name in _listed(first["hidden"]))
            row = await self._visit(_step(VISITS[1], number), planned, names)
            left_out += not _listed(first["measured"]) and not _listed(row["measured"])
        return left_out

    async def _visit(self, step_id: str, planned: PlannedPose, targets: Sequence[str]) -> Row:
        await self._nests_anew(step_id)
        return await self._ctx.step(
            step_id, f"pose {planned.name}", partial(self._measured, planned, targets)
        )

    async def _measured(self, planned: PlannedPose, targets: Sequence[str]) -> Row:
        """Drive to a pose from below and measure its targets; the row names the hidden ones."""
        self._time.begin()
        for attempt in range(_ATTEMPTS):
            await self._drive(planned)
            stood = await self._ctx.joints()
            found = [(name, await self._target(planned, name)) for name in targets]
            here = await self._ctx.joints()
            if (why := self._moved(stood, here)) is None:
                return self._kept(planned, found, here)
            self._left = None
            await self._ctx.warn(
                f"the arm no longer stands where it was at pose {planned.name}: {why}: somebody has moved it; "
                f"the pose is measured again ({attempt + 1} of {_ATTEMPTS}), leave the arm alone"
            )
        raise ArmMovedError(
            f"the arm was moved {_ATTEMPTS} times while pose {planned.name} was measured ({why}): find out who or "
            "what moves it, then continue with catseye resume"
        )

    def _moved(self, stood: Pose, here: Pose) -> str | None:
        """Return what shows that the arm was moved while a pose was measured; None when nothing does.

        Whether it had arrived there its driver has checked.

        Args:
            stood: joints read back before the measurement.
            here: after it.
        """
        if is_at(here, stood):
            return None
        number = max(range(len(here)), key=lambda k: abs(here[k] - stood[k]))
        axis = self._plan.bench.arm.axes[number]
        return (
            f"{axis.text(here[number], 3)} is read back instead of {axis.text(stood[number], 3)} before, more than "
            f"{SAME_PLACE:g} {axis.unit} off"
        )

    async def _drive(self, planned: PlannedPose) -> None:
        for pose in (*self._plan.way_to(planned, self._left), planned.pose):
            await self._ctx.move(pose)
        self._left = planned.pose

    async def _target(self, planned: PlannedPose, name: str) -> TargetPoint | TargetPose | None:
        """Measure a target; None when it is hidden, or too few of its marks are seen."""
        plan = self._plan
        try:
            if plan.measured == "poses":
                frame = await self._ctx.measure_frame(name, plan.settle_s, plan.dwell_s)
                seen = ((frame.visible, plan.marks), (frame.base_visible, plan.base_marks))
                return None if any(n is not None and n < fewest for n, fewest in seen) else frame
            near = near_mm(plan.bench, self._base, planned.pose, name)
            return await self._ctx.measure_target(name, plan.settle_s, plan.dwell_s, near)
        except HiddenTargetError:
            return None

    def _kept(
        self, planned: PlannedPose, found: list[tuple[str, TargetPoint | TargetPose | None]], here: Pose
    ) -> Row:
        measured = [(name, one) for name, one in found if one is not None]
        number = len(self._rounds) - 1 if self._rounds else None
        for name, one in measured:
            self._ctx.record(target_record(planned.name, name, one, (planned.pose, here), number))
        return {
            "measured": [name for name, _ in measured],
            "hidden": [name for name, one in found if one is None],
        }

    async def _summary(self, left_out: int) -> Row:
        poses = len(self._plan.poses)
        if left_out:
            await self._ctx.warn(
                f"{left_out} of {poses} poses stay without a target: each was hidden twice; see what stands between "
                "arm and instrument"
            )
        drifts = [max(drift_mm(self._rounds[0], one).values(), default=0.0) for one in self._rounds[1:]]
        if left_out > _LEFT_OUT * poses:
            raise HiddenTargetsError(
                f"{left_out} of {poses} poses stay without a target: see whether base_mm and base_deg "
                "in [tracker] and "
                "the normals of the tool's targets are right, then start again"
            )
        return {"poses": poses, "left_out": left_out, "nests_drift_mm": max(drifts, default=None)}


def _step(visit: str, number: int) -> str:
    return f"{visit}/{number:04d}"


def _listed(value: object) -> list[object]:
    return value if isinstance(value, list) else []


def _turn_prompt(turns: tuple[Turn, Turn]) -> Prompt:
    ranges = " and ".join(
        f"{turn.name} over {turn.values_deg[0]:.0f} … {turn.values_deg[-1]:.0f}°" for turn in turns
    )
    return TURN.prompt(
        f"turn/{turns[0].name}-{turns[1].name}",
        f"Check that {turns[0].target} sits in its nest and faces the instrument: the arm will drive to where it "
        f"is visible and turn {ranges}. Does it?",
        target=turns[0].pose(turns[0].values_deg[0]),
    )
