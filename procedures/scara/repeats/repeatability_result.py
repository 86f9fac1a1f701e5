"""Results of repeated arrivals: statistics along each beam, and of the position where there are several beams."""

import math

import numpy as np

from catseye.calibration.core.errors import CalibrationError, InsufficientPointsError
from catseye.calibration.standards.repeatability import AlongBeam, InPlane, along_beam, in_plane
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.records import Json, Row
from catseye.procedures.kit.stored import integer, number
from catseye.procedures.scara.repeats.repeatability_plan import ReflectorCycles, RepeatabilityPlan


class Series:
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


def take(series: list[Series], row: Row, cycle: int) -> None:
    """Take in what a cycle's step has stored."""
    values = row["displacement_mm"]
    if not isinstance(values, list):
        raise TypeError(f"a stored step result holds {values!r} where distances belong")
    for own, value in zip(series, values, strict=True):
        if value is not None:
            own.add(number(value), integer(row["segment"]), cycle)


def show(ctx: Context, series: list[Series]) -> None:
    """Show the largest S so far: nobody has stated what it should be, so it has no band."""
    known = [found.s_um for own in series if (found := _spread(own)) is not None]
    if known:
        name = series[0].part.reflector.name
        ctx.show(
            Live("largest S", max(known), "µm", text=f"of {len(known)} pose(s) along the beam to {name}")
        )


def _spread(series: Series) -> AlongBeam | None:
    try:
        return series.statistics() if series.cycle else None
    except InsufficientPointsError:
        return None


async def analyse(ctx: Context, plan: RepeatabilityPlan, series: list[Series]) -> Row:
    """Return the statistics of all poses, and publish them.

    Raises:
        InsufficientPointsError: no pose was attained twice with one dead path.
    """
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
            ctx.show(_live(own, one))
        if one is not None and one.drifts:
            await ctx.warn(
                f"pose {own.pose + 1} drifts by {one.drift_um:+.1f} µm over the cycles along the beam to "
                f"{own.part.reflector.name}: S = {one.s_um:.1f} µm includes this drift; warm the arm up first "
                "(catseye run warmup)"
            )
    positions: list[Json] = []
    if len(plan.reflectors) > 1:
        for pose in range(len(plan.poses)):
            row = await _position_row(ctx, pose, [pair for pair in found if pair[0].pose == pose])
            positions.append(row)
            await ctx.event("position-repeatability", **row)
    return {"beams": beams, "positions": positions}


def _live(own: Series, one: AlongBeam) -> Live:
    text = f"95 % interval {one.s_low_um:.1f}…{one.s_high_um:.1f} µm, RP ±{one.rp_um:.1f} µm, {one.arrivals} arrivals"
    return Live(
        f"S of pose {own.pose + 1} along the beam to {own.part.reflector.name}", one.s_um, "µm", text=text
    )


def _beam_row(plan: RepeatabilityPlan, own: Series, one: AlongBeam | None) -> dict[str, Json]:
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
    ctx: Context, pose: int, found: list[tuple[Series, AlongBeam | None]]
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
