"""Warm-up: the axes are exercised until the distance at a reference pose drifts no more than permitted."""

import math
from functools import partial
from typing import Annotated, Final

from pydantic import BaseModel, ConfigDict, Field

from catseye.calibration.core.settling import DriftRate
from catseye.procedures.kit.context import Context, Measurement
from catseye.procedures.kit.errors import NotWarmError
from catseye.procedures.kit.expanded import expanded_text
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Json, Row
from catseye.procedures.kit.stored import integer
from catseye.procedures.scara import texts
from catseye.procedures.scara.aiming import SEARCHED
from catseye.procedures.scara.beam.nests import Nests
from catseye.procedures.scara.before import ALIGNED, COUNTER, REFLECTORS, WARMING
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.explained import WARMUP
from catseye.procedures.scara.following.rounds import Rounds
from catseye.procedures.scara.motion.point_row import links_of
from catseye.procedures.scara.questions import ROUNDS
from catseye.procedures.scara.records import Drift
from catseye.procedures.scara.warming.warmup_plan import Exercise, WarmupPlan, plan_warmup
from catseye.procedures.scara.warming.warmup_watch import FEWEST_VISITS, Watch

VISIT: Final = "visit/"
"""Begin of the steps that visit the reference pose."""

_MOST_VISITS = 3
"""So many times the visits that are expected: an end for benches whose time stands still."""

Angle = Annotated[float, Field(ge=-360.0, le=360.0)]


class WarmupParams(BaseModel):
    """What may be chosen for a warm-up."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    reflector: str = Field(
        "", title="Reflector", description="name of the reflector to measure to; empty: the most suitable one"
    )
    reference_deg: list[Angle] | None = Field(
        None,
        min_length=2,
        max_length=2,
        title="Reference J1, J2, deg",
        description="J1 and J2 of the reference pose, deg; left out: chosen by the program",
    )
    amplitude_share: float = Field(
        0.6,
        gt=0.0,
        le=1.0,
        title="Travel, share of range",
        description="travel to either side, as a share of half the range of the nodes",
    )
    cycle_min: float = Field(
        1.0,
        ge=0.05,
        le=30.0,
        title="Exercise, min",
        description="duration of the exercise between two visits, min",
    )
    window_min: float = Field(
        30.0,
        ge=0.5,
        le=240.0,
        title="Drift over, min",
        description="time over which the drift is determined, min",
    )
    limit_um_per_10min: float = Field(
        5.0,
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
        120.0,
        ge=1.0,
        le=1440.0,
        title="At most, min",
        description="duration after which the warm-up is given up, min",
    )


class Warmup(Procedure):
    """Exercises the axes along tracked ways and watches a distance until its drift is below a limit."""

    name = "warmup"
    title = "Warm-up"
    explanation = WARMUP
    needs = Needs(ScaraBench, COUNTER, equipment=(REFLECTORS,), after=(ALIGNED,), basis=SEARCHED)
    stage = WARMING
    records = (Drift,)
    event_texts = texts.WARMUP
    questions = ROUNDS
    params_type = WarmupParams

    def plan(self, bench: ScaraBench, params: WarmupParams) -> WarmupPlan:
        """Plan the warm-up; see plan_warmup."""
        given = params.reference_deg
        reference = None if given is None else (given[0], given[1])
        exercise = Exercise(params.reflector, reference, params.amplitude_share, 60.0 * params.cycle_min)
        return plan_warmup(
            bench,
            exercise,
            60.0 * params.window_min,
            params.limit_um_per_10min,
            params.checks,
            60.0 * params.duration_limit_min,
        )

    async def run(self, ctx: Context, plan: WarmupPlan) -> None:
        """Exercise and watch.

        Raises:
            NotWarmError: the drift is not below the limit after the longest time.
            BeamLostError: the beam was lost again and again and the operator stops.
        """
        for text in plan.warnings:
            await ctx.warn(text)
        watch, late = Watch(plan), False
        rounds = Rounds(ctx, plan.bench, plan.trip, Nests(ctx, plan.bench))
        most = _MOST_VISITS * math.ceil(plan.duration_limit_s / plan.visit_s)
        for number in range(most):
            title = f"{plan.trip.reflector.name}: exercise, visit {number + 1}"
            row = await ctx.step(f"{VISIT}{number:04d}", title, partial(_visit, ctx, plan, rounds, number))
            rounds.segment = max(rounds.segment, integer(row["segment"]))
            await _report(ctx, plan, watch, watch.take(row))
            if watch.is_late and not late:
                late = True
                await ctx.warn(_late(plan, watch))
            if watch.warm or watch.is_over:
                break
        await ctx.step("analyse", "drift at the reference pose", partial(_analyse, ctx, plan, watch))
        if not watch.warm:
            raise NotWarmError(_not_warm(plan, watch))


async def _visit(ctx: Context, plan: WarmupPlan, rounds: Rounds, number: int) -> Row:
    """Exercise, come back to the reference pose and measure."""
    await rounds.begin()
    await _exercise(ctx, plan, rounds)
    measured = await rounds.measure(f"visit {number + 1}")
    if measured is None:
        return {"measured": False, "segment": rounds.segment}
    rounds.succeed()
    ctx.record(_record(plan, rounds.segment, number, measured))
    return {
        "measured": True,
        "segment": rounds.segment,
        "displacement_mm": measured.displacement_mm,
        "clock_s": measured.clock_s,
        "waited_s": ctx.waited_s,
    }


async def _exercise(ctx: Context, plan: WarmupPlan, rounds: Rounds) -> None:
    """Drive the planned rounds, or as many as last as long: a slow link or a fast emulator has fewer."""
    until_s = ctx.clock_s + plan.rounds * plan.trip.driving_s
    for _ in range(plan.rounds):
        began_s = ctx.clock_s
        for leg in plan.trip.legs:
            await rounds.drive(leg)
        if until_s - ctx.clock_s < 0.5 * (ctx.clock_s - began_s):
            break


def _record(plan: WarmupPlan, segment: int, number: int, measured: Measurement) -> Drift:
    return Drift(
        reflector=plan.trip.reflector.name,
        segment=segment,
        visit=number + 1,
        theta1_deg=plan.trip.stops[0][0],
        theta2_deg=plan.trip.stops[0][1],
        displacement_mm=measured.displacement_mm,
        spread_mm=measured.spread_mm,
        temperature_c=measured.air.temperature_c,
        time_utc=measured.time_utc,
        clock_s=measured.clock_s,
        extra=links_of(measured),
    )


async def _report(ctx: Context, plan: WarmupPlan, watch: Watch, again: bool) -> None:
    if again:
        await ctx.warn(
            "the beam, the run or the exercise was interrupted: the drift is watched again from here"
        )
    if watch.rate is not None:
        rate = watch.rate
        ctx.show(
            Live(
                "drift",
                rate.bound_um_per_10min,
                "µm/10 min",
                high=plan.limit_um_per_10min,
                text=f"{_drift_text(rate)} (k = 2) over the last {plan.window_s / 60:g} min",
            )
        )
    drift = (
        "drift not known yet"
        if watch.rate is None
        else f"drift ≤ {watch.rate.bound_um_per_10min:.1f} µm/10 min"
    )
    remaining_s = 0.0 if watch.warm else watch.remaining_s()
    ctx.progress(watch.elapsed_s, watch.elapsed_s + remaining_s, drift)


async def _analyse(ctx: Context, plan: WarmupPlan, watch: Watch) -> Row:
    """Keep the verdict."""
    rate = watch.rate
    verdict: dict[str, Json] = {
        "warm": watch.warm,
        "reflector": plan.trip.reflector.name,
        "drift_um_per_10min": None if rate is None else rate.um_per_10min,
        "u_drift_um_per_10min": None if rate is None else rate.u_um_per_10min,
        "limit_um_per_10min": plan.limit_um_per_10min,
        "visits": watch.visits,
        "elapsed_min": watch.elapsed_s / 60.0,
    }
    await ctx.event("warmup", **verdict)
    return verdict


def _late(plan: WarmupPlan, watch: Watch) -> str:
    limit, taken = plan.duration_limit_s / 60.0, watch.elapsed_s / 60.0
    return (
        f"after {taken:.0f} min there were too few visits for a verdict: they take longer than the planned "
        f"{plan.visit_s:.0f} s. The warm-up goes on beyond duration_limit_min = {limit:g} until there are "
        f"{FEWEST_VISITS + plan.checks - 1} of them, for twice as long at most"
    )


def _drift_text(rate: DriftRate) -> str:
    return expanded_text(rate.um_per_10min, rate.u_um_per_10min, 1, signed=True)


def _not_warm(plan: WarmupPlan, watch: Watch) -> str:
    limit, minutes = plan.limit_um_per_10min, watch.elapsed_s / 60.0
    rate = watch.rate
    if rate is None:
        return (
            f"after {minutes:.0f} min the drift is not known: {watch.visits} visit(s) since the beam was zeroed "
            f"last do not fill window_min = {plan.window_s / 60:g} with {FEWEST_VISITS} visits; look for what breaks "
            "the beam or slows the visits down, or choose a smaller amplitude_share or a longer duration_limit_min"
        )
    known = f"{_drift_text(rate)} µm in 10 min (k = 2), the limit is {limit:g}"
    if watch.below:
        remedy = (
            f"it was below the limit in {watch.below} of {plan.checks} checks in a row: run it again, or raise "
            "duration_limit_min"
        )
    elif rate.u_um_per_10min > 0.5 * limit:
        remedy = (
            "it is not known well enough: take a longer window_min, or a limit that the arm's scatter permits"
        )
    else:
        remedy = (
            "go on warming up (run it again, or raise duration_limit_min), and look for what warms arm, table or "
            "air; or accept a larger limit_um_per_10min"
        )
    return f"the arm is not warm after {minutes:.0f} min: the drift is {known}; {remedy}"
