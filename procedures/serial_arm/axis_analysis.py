"""What each joint does beside turning by what it is commanded (six-axis paper, section 4.1 and Table III)."""

from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from catseye.calibration.serial_arm.circles import AxisErrors, axis_errors
from catseye.drivers.roles.pose import Pose, pose_of
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.motion.bench_time import BenchTime
from catseye.procedures.kit.motion.motion_time import way_time_s
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Row
from catseye.procedures.serial_arm.axis_turns import FEWEST, Turn, drivable, turns_over
from catseye.procedures.serial_arm.before import AXIS_TEXTS, TARGETS, TRACKER, TURNING
from catseye.procedures.serial_arm.bench import SerialBench, ToolTarget
from catseye.procedures.serial_arm.explained import AXIS_ANALYSIS
from catseye.procedures.serial_arm.pose_params import rest_of
from catseye.procedures.serial_arm.pose_plan import PoseFinder
from catseye.procedures.serial_arm.records import MeasuredTarget
from catseye.procedures.serial_arm.turning import Turned, turned

Floats = NDArray[np.float64]
Degrees = Annotated[float, Field(ge=-720.0, le=720.0)]

STEP = "axis/"
"""Before the name of the joint in the name of the step that turns it."""

_TRIED = 60
"""Ways of standing among which the one is chosen from which a joint turns farthest in sight."""


class AxisParams(BaseModel):
    """What may be chosen for the analysis of axes."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    joints: list[str] = Field([], title="Axes", description="axes to turn; empty: all rotary axes")
    targets: list[str] = Field(
        [], title="Targets", description="targets of the tool to choose from; empty: all"
    )
    pose_deg: list[Degrees] = Field(
        [],
        title="Other axes at, deg",
        description="positions of the axes that do not turn, one value per axis; empty: where most of the turn is "
        "visible",
    )
    step_deg: float = Field(
        5.0, ge=0.1, le=45.0, title="Step, deg", description="angle between two positions, deg"
    )
    reach_deg: float = Field(
        400.0,
        ge=5.0,
        le=720.0,
        title="Turn at most ±, deg",
        description="largest turn to either side of the pose, deg",
    )
    approach_deg: float = Field(
        5.0,
        ge=0.1,
        le=20.0,
        title="Beyond the ends, deg",
        description="overrun at both ends, which takes up the play, deg",
    )
    rest_deg: list[Degrees] = Field(
        [], title="Rest pose, deg", description="pose from which the turns are reached; empty: zeros"
    )
    settle_s: float = Field(
        0.5, ge=0.0, le=60.0, title="Settling, s", description="wait at standstill before a measurement, s"
    )
    dwell_s: float = Field(
        4.0, ge=0.1, le=120.0, title="Averaging, s", description="time that the instrument averages over, s"
    )
    seed: int = Field(0, ge=0, le=2**31, title="Random seed", description="seed of the poses that are tried")


@dataclass(frozen=True)
class AxisPlan:
    """Turns of single joints, each in a step of its own.

    Attributes:
        bench: what it was made from.
        rest: from where every turn is reached.
        turns: in order.
        settle_s: wait after each motion.
        dwell_s: time over which the instrument averages.
    """

    bench: SerialBench
    rest: Pose
    turns: tuple[Turn, ...]
    settle_s: float
    dwell_s: float

    def turn_s(self, turn: Turn) -> float:
        """Return the expected bench time of a turn, s."""
        moving_s = way_time_s(self.bench.arm, np.array([self.rest, *turn.way, self.rest]))
        return moving_s + len(turn.order) * (self.settle_s + self.dwell_s)


class AxisAnalysis(Procedure):
    """Turns one joint after another through its range and back, in equal steps, and measures a target at each."""

    name = "axis-analysis"
    title = "Errors of single axes"
    explanation = AXIS_ANALYSIS
    needs = Needs(SerialBench, TRACKER, tracker=("points",), equipment=(TARGETS,))
    stage = TURNING
    records = (MeasuredTarget,)
    event_texts = AXIS_TEXTS
    params_type = AxisParams

    def plan(self, bench: SerialBench, params: AxisParams) -> AxisPlan:
        """Plan a turn of every joint.

        Raises:
            PlanError: a joint does not turn far enough in sight, or a name is unknown.
        """
        rest = rest_of(bench, params.rest_deg)
        turns = tuple(_turn(bench, params, joint, rest) for joint in _joints(bench, params.joints))
        return AxisPlan(bench, rest, turns, params.settle_s, params.dwell_s)

    async def run(self, ctx: Context, plan: AxisPlan) -> None:
        """Turn and measure; a joint that is done is not turned again.

        Raises:
            HiddenTargetsError: a target was seen at too few places.
        """
        time = BenchTime(ctx, sum(map(plan.turn_s, plan.turns)))
        for turn in plan.turns:
            await ctx.step(
                f"{STEP}{turn.name}", f"{turn.name} by itself", partial(_measured, ctx, plan, turn, time)
            )
            time.passed(plan.turn_s(turn), 0.0, turn.name)


async def _measured(ctx: Context, plan: AxisPlan, turn: Turn, time: BenchTime) -> Row:
    time.begin()
    await ctx.move(plan.rest)
    seen = await turned(ctx, plan.bench, turn, plan.settle_s, plan.dwell_s)
    await ctx.move(plan.rest)
    row = figures_of(turn, seen)
    await ctx.event("axis-turned", **row)
    return row


def figures_of(turn: Turn, seen: Turned) -> Row:
    """Return a line of Table III."""
    found = errors_about_axis(seen.command_deg, seen.place_mm, seen.from_below)
    return {
        "joint": turn.name,
        "target": turn.target,
        "low_deg": float(seen.command_deg.min()),
        "high_deg": float(seen.command_deg.max()),
        "radius_mm": found.circle.radius_mm,
        "tangential_range_mm": found.tangential_range_mm,
        "angular_range_deg": found.angular_range_deg,
        "backlash_deg": found.backlash_deg,
        "radial_std_mm": float(found.radial_mm.std()),
        "axial_std_mm": float(found.axial_mm.std()),
        "hidden": list(seen.hidden),
    }


def errors_about_axis(command_deg: Floats, place_mm: Floats, from_below: NDArray[np.bool_]) -> AxisErrors:
    """Return errors that count from the joint at 0, as in the paper, or from the middle of what it shows.

    Args:
        command_deg: of the joint, shape (n,).
        place_mm: of the target, shape (n, 3).
        from_below: the joint came by a positive motion, shape (n,).
    """
    at = 0.0 if command_deg.min() <= 0.0 <= command_deg.max() else float(np.median(command_deg))
    return axis_errors(command_deg, place_mm, from_below, at)


def _joints(bench: SerialBench, names: list[str]) -> list[int]:
    """Return the numbers of the joints to turn, from 1."""
    turning = {axis.name: number for number, axis in enumerate(bench.arm.axes, 1) if axis.unit == "deg"}
    if unknown := [name for name in names if name not in turning]:
        raise PlanError(
            f"{unknown[0]} is not an axis that turns: there are {', '.join(turning)}; correct joints"
        )
    return [turning[name] for name in names or turning]


def _turn(bench: SerialBench, params: AxisParams, joint: int, rest: Pose) -> Turn:
    targets = bench.chosen(params.targets)
    best: Turn | None = None
    for turns in turns_over(
        bench,
        _standing(bench, params, targets, rest),
        joint,
        targets,
        params.step_deg,
        params.reach_deg,
        params.approach_deg,
        both_ways=True,
    ):
        for turn in turns:
            longer = len(turn.values_deg) > (len(best.values_deg) if best else FEWEST - 1)
            if longer and drivable(bench, turn, rest):
                best = turn
    if best is None:
        raise PlanError(
            f"{bench.arm.axes[joint - 1].name}: nowhere a target stays in sight over {FEWEST - 1} steps of "
            f"{params.step_deg:g} deg: choose smaller steps, another pose_deg, turn the nests, or "
            "leave the joint out"
        )
    return best


def _standing(
    bench: SerialBench, params: AxisParams, targets: tuple[ToolTarget, ...], rest: Pose
) -> list[Pose]:
    if params.pose_deg:
        try:
            return [pose_of(bench.arm.axes, params.pose_deg)]
        except ValueError as error:
            raise PlanError(f"pose_deg: {error}; give one value for each axis") from error
    drawn = PoseFinder(bench, targets, "points", params.approach_deg, rest).drawn(_TRIED, params.seed)
    return [rest, *(tuple(pose) for pose in drawn.tolist())]
