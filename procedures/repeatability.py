"""Repeatability: poses attained again and again, after ISO 9283, seen along the beams to one or more reflectors."""

import math
from collections.abc import Sequence
from functools import partial
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from calibration.errors import CalibrationError, InsufficientPointsError
from calibration.repeatability import AlongBeam, InPlane, along_beam, in_plane
from procedures.bench import Bench
from procedures.context import Context, Json, Live, Measurement, Row
from procedures.nests import Nests
from procedures.repeatability_plan import ReflectorCycles, RepeatabilityPlan, plan_repeatability
from procedures.round_trip import Rounds

Angle = Annotated[float, Field(ge=-360.0, le=360.0)]
PoseParam = Annotated[list[Angle], Field(min_length=2, max_length=2)]


class RepeatabilityParams(BaseModel):
    """What may be chosen for a repeatability test."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    poses: (
        Annotated[int, Field(ge=1, le=50)] | Annotated[list[PoseParam], Field(min_length=1, max_length=50)]
    ) = Field(5, description="how many poses to spread over the nodes, or [[J1, J2], …] in deg")
    cycles: int = Field(30, ge=2, le=1000, description="how often each pose is attained")
    reflectors: list[str] = Field([], description="names of the reflectors to see it from; all when empty")


class Repeatability:
    """Attains poses from fixed run-ins with the beam kept, cycle after cycle, on each reflector in turn."""

    name = "repeatability"
    title = "Pose repeatability"
    needs_aim = True
    needs_tracker = False
    params_type = RepeatabilityParams

    def plan(self, bench: Bench, params: RepeatabilityParams) -> RepeatabilityPlan:
        """Plan the test; see plan_repeatability."""
        given = params.poses
        poses = given if isinstance(given, int) else tuple((pose[0], pose[1]) for pose in given)
        return plan_repeatability(bench, poses, params.cycles, tuple(params.reflectors))

    async def run(self, ctx: Context, plan: RepeatabilityPlan) -> None:
        """Attain all poses in all cycles.

        Args:
            ctx: the bench.
            plan: what plan_repeatability returned.

        Raises:
            BeamLostError: the beam was lost again and again and the operator stops.
            InsufficientPointsError: no pose was attained twice with one dead path.
        """
        done_s, nests = 0.0, Nests(ctx, plan.bench)
        series: list[_Series] = []
        for part, cycle_s in zip(plan.reflectors, plan.cycle_s, strict=True):
            rounds = Rounds(ctx, plan.bench, part.trip, nests)
            own = [_Series(part, pose) for pose in range(len(plan.poses))]
            for cycle in range(plan.cycles):
                title = f"{part.reflector.name}: cycle {cycle + 1} of {plan.cycles}"
                step_id = f"{part.reflector.name}/cycle/{cycle:04d}"
                row = await ctx.step(step_id, title, partial(_cycle, ctx, plan, part, rounds, cycle))
                rounds.segment = max(rounds.segment, int(_number(row["segment"])))
                _take(own, row, cycle)
                _show(ctx, own)
                done_s += cycle_s
                ctx.progress(done_s, plan.duration_s, title)
            series += own
        await ctx.step("analyse", "repeatability of the poses", partial(_analyse, ctx, plan, series))

    async def teardown(self, ctx: Context) -> None:
        """Leave the arm where it stands."""


class _Series:
    """Distances of one pose to one reflector."""

    def __init__(self, part: ReflectorCycles, pose: int) -> None:
        self.part = part
        self.pose = pose
        self.displacement_mm: list[float] = []
        self.segment: list[int] = []
        self.cycle: list[int] = []

    def add(self, displacement_mm: float, segment: int, cycle: int) -> None:
        """Add an arrival."""
        self.displacement_mm.append(displacement_mm)
        self.segment.append(segment)
        self.cycle.append(cycle)

    def statistics(self) -> AlongBeam:
        """Return the repeatability along the beam; raises InsufficientPointsError without a spread."""
        return along_beam(np.array(self.displacement_mm), np.array(self.segment), np.array(self.cycle))


async def _cycle(
    ctx: Context, plan: RepeatabilityPlan, part: ReflectorCycles, rounds: Rounds, cycle: int
) -> Row:
    """Attain all poses once; a cycle in which the beam is lost is driven again in a new segment."""
    while True:
        await rounds.begin()
        attained = await _attained(part, rounds, cycle)
        if rounds.ready:
            break
    rounds.succeed()
    for pose, measured in enumerate(attained):
        if measured is not None:
            ctx.record("records", _record(plan, part, rounds.segment, cycle, pose, measured))
    return {
        "segment": rounds.segment,
        "displacement_mm": [None if measured is None else measured.displacement_mm for measured in attained],
    }


async def _attained(part: ReflectorCycles, rounds: Rounds, cycle: int) -> Sequence[Measurement | None]:
    """Drive a cycle; what is returned holds only if the beam lasted."""
    attained: list[Measurement | None] = []
    for number, leg in enumerate(part.trip.legs):
        await rounds.drive(leg)
        if number % 2:
            continue
        pose = number // 2
        # A point that the operator leaves out is None too, but the beam is still counted.
        where = f"{part.reflector.name} pose {pose + 1} cycle {cycle + 1}"
        attained.append(await rounds.measure(where))
        if not rounds.ready:
            break
    return attained


def _record(
    plan: RepeatabilityPlan, part: ReflectorCycles, segment: int, cycle: int, pose: int, measured: Measurement
) -> Row:
    row: dict[str, Json] = {
        "kind": "repeat",
        "reflector": part.reflector.name,
        "segment": segment,
        "cycle": cycle + 1,
        "pose": pose + 1,
        "theta1_deg": plan.poses[pose][0],
        "theta2_deg": plan.poses[pose][1],
        "direction1": 1,
        "direction2": 1,
        "displacement_mm": measured.displacement_mm,
        "spread_mm": measured.spread_mm,
        "signal": measured.signal,
        "temperature_c": measured.air.temperature_c,
        "time_utc": measured.time_utc,
    }
    return row if measured.material_c is None else {**row, "material_c": measured.material_c}


def _take(series: list[_Series], row: Row, cycle: int) -> None:
    values = row["displacement_mm"]
    if not isinstance(values, list):
        raise TypeError(f"a stored step result holds {values!r} where distances belong")
    for own, value in zip(series, values, strict=True):
        if value is not None:
            own.add(_number(value), int(_number(row["segment"])), cycle)


def _show(ctx: Context, series: list[_Series]) -> None:
    """Show the largest S so far: nobody has stated what it should be, so it has no band."""
    known = [found.s_um for own in series if (found := _spread(own)) is not None]
    if known:
        name = series[0].part.reflector.name
        ctx.show(
            Live("largest S", max(known), "µm", text=f"of {len(known)} pose(s) along the beam to {name}")
        )


def _spread(series: _Series) -> AlongBeam | None:
    try:
        return series.statistics() if series.cycle else None
    except InsufficientPointsError:
        return None


async def _analyse(ctx: Context, plan: RepeatabilityPlan, series: list[_Series]) -> Row:
    found = [(own, _spread(own)) for own in series]
    if all(one is None for _, one in found):
        raise InsufficientPointsError(
            "no pose was attained twice with one dead path: the beam broke in every cycle; look for what breaks it"
        )
    beams: list[Json] = []
    for own, one in found:
        row = _beam_row(plan, own, one)
        beams.append(row)
        await ctx.event("repeatability", **row)
        if one is not None:
            ctx.show(_told(own, one))
        if one is not None and one.drifts:
            await ctx.warn(
                f"pose {own.pose + 1} drifts by {one.drift_um:+.1f} µm over the cycles along the beam to "
                f"{own.part.reflector.name}: S = {one.s_um:.1f} µm holds it too; warm the arm up first "
                "(catseye run warmup)"
            )
    positions: list[Json] = []
    if len(plan.reflectors) > 1:
        for pose in range(len(plan.poses)):
            row = await _position_row(ctx, pose, [pair for pair in found if pair[0].pose == pose])
            positions.append(row)
            await ctx.event("position-repeatability", **row)
    return {"beams": beams, "positions": positions}


def _told(own: _Series, one: AlongBeam) -> Live:
    text = f"95 % interval {one.s_low_um:.1f}…{one.s_high_um:.1f} µm, RP ±{one.rp_um:.1f} µm, {one.arrivals} arrivals"
    return Live(
        f"S of pose {own.pose + 1} along the beam to {own.part.reflector.name}", one.s_um, "µm", text=text
    )


def _beam_row(plan: RepeatabilityPlan, own: _Series, one: AlongBeam | None) -> dict[str, Json]:
    theta1_deg, theta2_deg = plan.poses[own.pose]
    row: dict[str, Json] = {"pose": own.pose + 1, "reflector": own.part.reflector.name}
    place: dict[str, Json] = {
        "theta1_deg": theta1_deg,
        "theta2_deg": theta2_deg,
        "beam_deg": round(math.degrees(own.part.direction_rad[own.pose]), 3),
    }
    if one is None:
        return {**row, "refused": "no two arrivals share a dead path", **place}
    return {
        **row,
        "s_um": one.s_um,
        "s_low_um": one.s_low_um,
        "s_high_um": one.s_high_um,
        "rp_um": one.rp_um,
        "range_um": one.range_um,
        "drift_um": one.drift_um,
        "drift_probability": one.drift_probability,
        "arrivals": one.arrivals,
        "dof": one.dof,
        "mean_mm": one.mean_mm,
        "segment": one.segment,
        **place,
    }


async def _position_row(
    ctx: Context, pose: int, found: list[tuple[_Series, AlongBeam | None]]
) -> dict[str, Json]:
    """Return the spread of the position at a pose, or why there is none.

    The beams were measured one after another, so their distances at one arrival do not belong together: variances
    along the beams enter, covariances between them do not exist.
    """
    known = [(own.part.direction_rad[pose], one) for own, one in found if one is not None]
    try:
        plane = in_plane(
            np.array([direction for direction, _ in known]),
            np.array([one.s_um for _, one in known]),
            np.array([one.dof for _, one in known]),
        )
    except CalibrationError as error:
        await ctx.warn(f"pose {pose + 1}: {error}")
        return {"pose": pose + 1, "refused": str(error)}
    return _plane_row(pose, plane)


def _plane_row(pose: int, plane: InPlane) -> dict[str, Json]:
    (xx, xy), (_, yy) = plane.covariance_um2.tolist()
    return {
        "pose": pose + 1,
        "rp_um": plane.rp_um,
        "u_rp_um": plane.u_rp_um,
        "sx_um": math.sqrt(xx),
        "sy_um": math.sqrt(yy),
        "covariance_xy_um2": xy,
        "assumption": plane.assumption,
        "basis": "variances along beams that were measured one after another",
    }


def _number(value: Json) -> float:
    if isinstance(value, int | float):
        return float(value)
    raise TypeError(f"a stored step result holds {value!r} where a number belongs")
