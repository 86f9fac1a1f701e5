"""Warm-up of a serial arm: it is exercised until a target at a reference pose drifts no more than permitted."""

from dataclasses import dataclass, field
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from catseye.calibration.core.settling import FEWEST_VISITS, drift_rate
from catseye.drivers.roles.errors import HiddenTargetError
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import HiddenTargetsError, NotWarmError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.motion.motion_time import way_time_s
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number, number_of, numbers_of
from catseye.procedures.serial_arm.before import TARGETS, TRACKER, WARM_TEXTS, WARMING
from catseye.procedures.serial_arm.bench import SerialBench
from catseye.procedures.serial_arm.explained import TRACKER_WARMUP
from catseye.procedures.serial_arm.pose_params import name_of, rest_of
from catseye.procedures.serial_arm.pose_plan import PlannedPose, PoseFinder
from catseye.procedures.serial_arm.records import MeasuredTarget, target_record
from catseye.procedures.serial_arm.tracker_validation import reachable
from catseye.procedures.serial_arm.turning import near_mm

Floats = NDArray[np.float64]

VISIT: Final = "visit/"
"""Before the number of a visit in the name of its step."""

_MOST_HIDDEN: Final = 5
"""Visits in a row at which the target may be hidden."""

_COMPLETE: Final = 0.95
"""Visits of a full window span this share of it: the next one would lie beyond it."""

_REST: Final = 3.0
"""Who was waited for so many times longer than a visit is planned has let the arm cool."""


class WarmupParams(BaseModel):
    """What may be chosen for a warm-up."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    targets: list[str] = Field(
        [], title="Targets", description="targets of the tool to choose from; empty: all"
    )
    exercise_poses: int = Field(
        8,
        ge=1,
        le=100,
        title="Poses in a cycle",
        description="number of random poses in each cycle",
    )
    cycles: int = Field(
        3,
        ge=1,
        le=100,
        title="Cycles between visits",
        description="number of cycles between two visits to the reference pose",
    )
    window_min: float = Field(
        20.0,
        ge=0.5,
        le=240.0,
        title="Drift over, min",
        description="time over which the drift is determined, min",
    )
    limit_um_per_10min: float = Field(
        25.0,
        ge=0.1,
        le=1000.0,
        title="Limit, µm in 10 min",
        description="largest accepted drift, µm in 10 min",
    )
    checks: int = Field(
        3,
        ge=1,
        le=100,
        title="Visits below the limit",
        description="number of consecutive visits that have to be below the limit",
    )
    duration_limit_min: float = Field(
        90.0,
        ge=1.0,
        le=1440.0,
        title="At most, min",
        description="duration after which the warm-up is given up, min",
    )
    approach_deg: float = Field(
        5.0,
        ge=0.0,
        le=20.0,
        title="Approach from, deg",
        description="every axis approaches its position from this much below, deg",
    )
    rest_deg: list[float] = Field(
        [], title="Rest pose, deg", description="pose from which all others are reached; empty: zeros"
    )
    settle_s: float = Field(
        0.5, ge=0.0, le=60.0, title="Settling, s", description="wait at standstill before a measurement, s"
    )
    dwell_s: float = Field(
        4.0, ge=0.1, le=120.0, title="Averaging, s", description="time that the instrument averages over, s"
    )
    seed: int = Field(0, ge=0, le=2**31, title="Random seed", description="seed of the random poses")


@dataclass(frozen=True)
class WarmupPlan:
    """An exercise, and the pose that is visited after it.

    Attributes:
        bench: what it was made from.
        params: as chosen.
        rest: from where every pose is reached.
        reference: where the target is measured.
        exercise: poses that are driven through in each cycle.
    """

    bench: SerialBench
    params: WarmupParams
    rest: Pose
    reference: PlannedPose
    exercise: tuple[PlannedPose, ...]

    @property
    def way(self) -> tuple[Pose, ...]:
        """Everything that is driven between two visits; every leg of it is reached from the rest pose."""
        cycle = [pose for one in self.exercise for pose in (one.approach, one.pose, one.approach, self.rest)]
        last = self.reference
        return (*cycle * self.params.cycles, last.approach, last.pose)

    @property
    def visit_s(self) -> float:
        """Expected bench time from visit to visit, s."""
        way = np.array([self.reference.pose, self.reference.approach, self.rest, *self.way])
        return way_time_s(self.bench.arm, way) + self.params.settle_s + self.params.dwell_s


class TrackerWarmup(Procedure):
    """Exercises all axes and watches a target until its drift is below a limit (six-axis paper, section 6: 1 h)."""

    name = "tracker-warmup"
    title = "Warm-up of a serial arm"
    explanation = TRACKER_WARMUP
    needs = Needs(SerialBench, TRACKER, tracker=("points",), equipment=(TARGETS,))
    stage = WARMING
    records = (MeasuredTarget,)
    event_texts = WARM_TEXTS
    params_type = WarmupParams

    def plan(self, bench: SerialBench, params: WarmupParams) -> WarmupPlan:
        """Choose the poses.

        Raises:
            PlanError: too few poses can be measured and reached.
        """
        rest = rest_of(bench, params.rest_deg)
        finder = PoseFinder(bench, bench.chosen(params.targets), "points", params.approach_deg, rest)
        named = reachable(finder, params.exercise_poses + 1, params.seed)
        reference, *exercise = finder.linked(named, 1)
        return WarmupPlan(bench, params, rest, reference, tuple(exercise))

    async def run(self, ctx: Context, plan: WarmupPlan) -> None:
        """Exercise and watch.

        Raises:
            NotWarmError: the drift is not below the limit after the longest time.
            HiddenTargetsError: the target was hidden again and again.
        """
        watch = Watch(plan)
        limit_s = 60.0 * plan.params.duration_limit_min
        number, begins = 0, True
        while not watch.warm and watch.elapsed_s < limit_s:
            step_id, title = f"{VISIT}{number:04d}", f"exercise, visit {number + 1}"
            stored = ctx.is_done(step_id)
            watch.take(await ctx.step(step_id, title, partial(_visit, ctx, plan, number, begins=begins)))
            _show(ctx, plan, watch, limit_s)
            number, begins = number + 1, stored
        await ctx.step("verdict", "drift at the reference pose", partial(_verdict, ctx, plan, watch))
        if not watch.warm:
            known = "not known" if watch.drift is None else f"{watch.drift:.1f} µm in 10 min"
            if watch.below:
                known = f"{known}, below the limit in {watch.below} of {plan.params.checks} checks in a row"
            raise NotWarmError(
                f"after {watch.elapsed_s / 60.0:.0f} min the drift is {known}, the limit "
                f"{plan.params.limit_um_per_10min:g}: run it again, raise duration_limit_min, look "
                "for what warms arm, "
                "table or instrument, or accept a larger limit_um_per_10min"
            )


async def _visit(ctx: Context, plan: WarmupPlan, number: int, *, begins: bool) -> Row:
    """Exercise, come to the reference pose from below and measure.

    Args:
        begins: this process has made no visit before.
    """
    for pose in (plan.rest, *plan.way):
        await ctx.move(pose)
    params, reference = plan.params, plan.reference
    target = reference.targets[0]
    near = near_mm(plan.bench, plan.bench.instrument.base, reference.pose, target)
    try:
        found = await ctx.measure_target(target, params.settle_s, params.dwell_s, near)
    except HiddenTargetError:
        found = None
    here = await ctx.joints()
    for pose in (reference.approach, plan.rest):
        await ctx.move(pose)
    visit: Row = {"clock_s": ctx.clock_s, "waited_s": ctx.waited_s, "begins": begins}
    if found is None:
        return {**visit, "place_mm": None}
    ctx.record(target_record(name_of(number + 1), target, found, (reference.pose, here), None))
    return {**visit, "place_mm": list(found.place_mm)}


@dataclass(frozen=True)
class _Seen:
    """A visit at which the target was seen."""

    time_s: float
    waited_s: float
    place_mm: list[float]


@dataclass
class Watch:
    """The drift at the reference pose as the visits show it.

    Attributes:
        plan: with limit and window.
        drift: of the last window, µm in 10 min; None while it is unknown.
        elapsed_s: of exercise; rests between processes do not count.
    """

    plan: WarmupPlan
    drift: float | None = None
    elapsed_s: float = 0.0
    _series: list[_Seen] = field(default_factory=list)
    _below: int = 0
    _hidden: int = 0

    @property
    def below(self) -> int:
        """Visits in a row, the last one included, at which the drift was below the limit."""
        return self._below

    @property
    def warm(self) -> bool:
        """The drift was below the limit often enough."""
        return self._below >= self.plan.params.checks

    def take(self, row: Row) -> None:
        """Take a visit in.

        Raises:
            HiddenTargetsError: the target was hidden again and again.
        """
        clock_s = number_of(row, "clock_s")
        # Runs of before do not say who was waited for.
        waited_s = number(row.get("waited_s", 0.0))
        if self._series and (begins_anew(row, self._series[-1].time_s) or self._rested(waited_s)):
            self._series, self._below, self.drift = [], 0, None
        if row["place_mm"] is None:
            self._hidden += 1
            self.elapsed_s += self.plan.visit_s
            if self._hidden >= _MOST_HIDDEN:
                raise HiddenTargetsError(
                    f"{self.plan.reference.targets[0]} was hidden at {_MOST_HIDDEN} visits in a row: "
                    "turn the nest to "
                    "the instrument and clear the line of sight, then continue with catseye resume"
                )
            return
        self._hidden = 0
        self.elapsed_s += clock_s - self._series[-1].time_s if self._series else self.plan.visit_s
        self._series.append(_Seen(clock_s, waited_s, numbers_of(row, "place_mm")))
        self._judge()

    def _rested(self, waited_s: float) -> bool:
        """Return whether the arm stood still for long since the last visit: a hold, an open door, a question.

        A visit that takes long by itself is none: a low override or a slow link makes it last.
        """
        return waited_s - self._series[-1].waited_s > _REST * self.plan.visit_s

    def _judge(self) -> None:
        times = np.array([seen.time_s for seen in self._series])
        places = np.array([seen.place_mm for seen in self._series])
        self.drift = drift_of(times, places, 60.0 * self.plan.params.window_min)
        below = self.drift is not None and self.drift <= self.plan.params.limit_um_per_10min
        self._below = self._below + 1 if below else 0


def begins_anew(row: Row, before_s: float) -> bool:
    """Return whether a visit was made by another process than the one before: the clock has another origin.

    Args:
        before_s: by the clock of its process, when the visit before was made.
    """
    # Runs of before do not say which visit is the first of a process.
    return row.get("begins") is True or number_of(row, "clock_s") <= before_s


def drift_of(time_s: Floats, place_mm: Floats, window_s: float) -> float | None:
    """Return the drift over the window that ends at the last visit, µm in 10 min; None before a window is full.

    Args:
        time_s: of the visits, growing, shape (n,).
        place_mm: of the target, shape (n, 3).
        window_s: over which it is taken.
    """
    if time_s[-1] - time_s[0] < _COMPLETE * window_s or len(time_s) < FEWEST_VISITS:
        return None
    # Where the exercise takes long, a window holds too few visits for a slope: those before it count too.
    recent = time_s >= min(time_s[-1] - window_s, time_s[-FEWEST_VISITS])
    rates = [drift_rate(time_s[recent], along) for along in place_mm[recent].T]
    known = [rate.um_per_10min for rate in rates if rate is not None]
    return float(np.linalg.norm(known)) if len(known) == 3 else None


def _show(ctx: Context, plan: WarmupPlan, watch: Watch, limit_s: float) -> None:
    if watch.drift is not None:
        ctx.show(Live("drift", watch.drift, "µm/10 min", high=plan.params.limit_um_per_10min))
    left_s = 0.0 if watch.warm else max(limit_s - watch.elapsed_s, 0.0)
    ctx.progress(watch.elapsed_s, watch.elapsed_s + left_s, "warm-up")


async def _verdict(ctx: Context, plan: WarmupPlan, watch: Watch) -> Row:
    row: Row = {
        "warm": watch.warm,
        "drift_um_per_10min": watch.drift,
        "limit_um_per_10min": plan.params.limit_um_per_10min,
        "elapsed_min": watch.elapsed_s / 60.0,
    }
    await ctx.event("warmed", **row)
    return row
