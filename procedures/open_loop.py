"""The automated open-loop tracking measurement, step by step."""

import math
from collections.abc import Awaitable, Callable

from pydantic import BaseModel, ConfigDict, Field

from procedures.beam_scan import find_return, half_window_deg
from procedures.bench import Bench
from procedures.context import Context, Json, Measurement, Row
from procedures.devices import Joints
from procedures.errors import BeamLostError
from procedures.open_loop_plan import OpenLoopPlan, ReflectorPlan, Visit, plan_open_loop

_MOST_POINTS_LOST = 5
"""So many points lost one after the other mean that the reflector is not where it is aimed at."""

_RECOVERY_HALF_RANGE_DEG = 0.5


class OpenLoopParams(BaseModel):
    """What may be chosen for a measurement."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    reflectors: list[str] = Field([], description="names of the reflectors to measure; all when empty")
    subdivide: bool = Field(True, description="split moves so that the beam is kept; false shows what breaks")
    take_up: bool = Field(True, description="approach each node from its side; false shows what that shifts")


class OpenLoop:
    """Visits every node from both sides with the beam on each reflector in turn and records the distances."""

    name = "open-loop"
    title = "Automated open-loop tracking measurement"
    needs_aim = True
    needs_tracker = False
    params_type = OpenLoopParams

    def plan(self, bench: Bench, params: OpenLoopParams) -> OpenLoopPlan:
        """Plan the measurement; see plan_open_loop."""
        return plan_open_loop(
            bench,
            subdivide=params.subdivide,
            take_up=params.take_up,
            reflectors=tuple(params.reflectors),
        )

    async def run(self, ctx: Context, plan: OpenLoopPlan) -> None:
        """Measure all reflectors.

        Args:
            ctx: the bench.
            plan: what plan_open_loop returned.

        Raises:
            BeamLostError: several points in a row without a beam.
        """
        done_s, total_s = 0.0, plan.duration_s
        for text in plan.warnings:
            await ctx.warn(text)
        for part in plan.reflectors:
            campaign = _ReflectorCampaign(ctx, plan, part)
            for visit in part.visits:
                await campaign.visit(visit)
                done_s += visit.duration_s
                name = f"{part.reflector.name} point {visit.command.index + 1}/{part.visits[-1].command.index + 1}"
                ctx.progress(done_s, total_s, name)

    async def teardown(self, ctx: Context) -> None:
        """Leave the arm where it stands."""


class _ReflectorCampaign:
    """The measurement of one reflector: knows the present segment and how many points were lost in a row."""

    def __init__(self, ctx: Context, plan: OpenLoopPlan, part: ReflectorPlan) -> None:
        self._ctx = ctx
        self._bench = plan.bench
        self._reflector = part.reflector
        self._segment = -1
        self._lost_in_a_row = 0
        self._j4_deg = 0.0

    async def visit(self, visit: Visit) -> None:
        """Go to a point and measure it."""
        step_id = f"{self._reflector.name}/{visit.command.index:04d}"
        result = await self._ctx.step(step_id, self._title(visit), self._action(visit))
        self._segment = max(self._segment, _integer(result["segment"]))
        self._lost_in_a_row = 0 if result["measured"] else self._lost_in_a_row + 1
        if self._lost_in_a_row > _MOST_POINTS_LOST:
            raise BeamLostError(
                f"no beam at {self._lost_in_a_row} points in a row on reflector {self._reflector.name}: check that "
                "nothing stands in the beam, that the reflector has not been moved, and search for it again"
            )

    def _title(self, visit: Visit) -> str:
        c = visit.command
        return (
            f"{self._reflector.name}: θ1 {c.theta1_deg:g}° ({'+' if c.direction1 > 0 else '−'}), "
            f"θ2 {c.theta2_deg:g}° ({'+' if c.direction2 > 0 else '−'})"
        )

    def _action(self, visit: Visit) -> Callable[[], Awaitable[Row]]:
        async def action() -> Row:
            for leg in visit.legs:
                await self._ctx.follow(leg)
            self._j4_deg = visit.moves[-1][3]
            measured = await (self._measure() if visit.tracked else self._measure_anew(visit))
            if visit.tracked and measured is not None and not measured.beam_ok:
                await self._tell_lost(visit)
                measured = await self._measure_anew(visit)
            if measured is None:
                return {"measured": False, "segment": self._segment}
            self._record(visit, measured)
            return {"measured": True, "segment": self._segment, "displacement_mm": measured.displacement_mm}

        return action

    async def _measure(self) -> Measurement:
        timing = self._bench.timing
        return await self._ctx.measure(timing.settle_time_s, timing.dwell_time_s, timing.readings)

    async def _measure_anew(self, visit: Visit) -> Measurement | None:
        """Find the beam at or near the aim, begin a new segment and measure; None when it is not to be had."""
        found = (await self._ctx.beam()).beam_ok or await self._found_near(visit.moves[-1], visit.beam_mm)
        if found:
            await self._ctx.zero(visit.beam_mm)
            self._segment += 1
            measured = await self._measure()
            if measured.beam_ok:
                return measured
        what = "the beam does not last" if found else "no beam"
        await self._ctx.warn(
            f"{what} at {self._title(visit)}: the point is left out; check what stands in the beam's way"
        )
        return None

    async def _tell_lost(self, visit: Visit) -> None:
        await self._ctx.event(
            "beam-lost", reflector=self._reflector.name, point=visit.command.index, segment=self._segment
        )

    async def _found_near(self, target: Joints, beam_mm: float) -> bool:
        optics = self._bench.optics
        window = await find_return(
            self._ctx,
            target,
            _RECOVERY_HALF_RANGE_DEG,
            half_window_deg(optics.acceptance_mm, beam_mm),
            self._bench.arm.j4_limits_deg,
        )
        if window is None:
            return False
        self._j4_deg = window.centre_deg
        return True

    def _record(self, visit: Visit, measured: Measurement) -> None:
        command, target, reported = visit.command, visit.moves[-1], measured.reported
        self._ctx.record(
            "points",
            {
                "reflector": self._reflector.name,
                "segment": self._segment,
                "theta1_deg": command.theta1_deg,
                "theta2_deg": command.theta2_deg,
                "j3_mm": target[2],
                "j4_deg": self._j4_deg,
                "reported1_deg": reported[0],
                "reported2_deg": reported[1],
                "reported3_mm": reported[2],
                "reported4_deg": reported[3],
                "direction1": command.direction1,
                "direction2": command.direction2,
                "displacement_mm": measured.displacement_mm,
                "spread_mm": measured.spread_mm,
                "readings": measured.readings,
                "signal": measured.signal,
                "temperature_c": measured.air.temperature_c,
                "pressure_hpa": measured.air.pressure_hpa,
                "humidity_percent": measured.air.humidity_percent,
                "time_utc": measured.time_utc,
                "duration_s": measured.duration_s,
                **_correction(measured),
                **({} if measured.material_c is None else {"material_c": measured.material_c}),
            },
        )


def _correction(measured: Measurement) -> dict[str, Json]:
    used = measured.correction
    if used is None:
        return {}
    return {
        "raw_displacement_mm": used.raw_displacement_mm,
        "refractive_index": used.refractive_index,
        "zero_refractive_index": used.zero_refractive_index,
        "dead_path_mm": used.dead_path_mm,
        "formula": used.formula,
    }


def _integer(value: object) -> int:
    if isinstance(value, int) and not isinstance(value, bool):
        return value
    if isinstance(value, float) and math.isfinite(value):
        return int(value)
    raise TypeError(f"a stored step result holds {value!r} where a segment number belongs")
