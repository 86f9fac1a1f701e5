"""Reflector search: places of the reflectors and the beam's zero direction (Remark 1, Eq. 2)."""

import math
from dataclasses import dataclass

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from calibration.errors import CalibrationError
from calibration.reflector_search import SearchResult, Sightings, locate_reflectors
from procedures.beam_scan import find_return, half_window_deg
from procedures.bench import Bench
from procedures.context import Context, Json, Row
from procedures.errors import ReflectorNotFoundError
from procedures.search_plan import SearchPlan, SearchPose, plan_search

_FEWEST_SIGHTINGS = 3

_COVERAGE = 2.0
"""Twice the standard uncertainty of the aim has to leave room for the plan's own miss."""


@dataclass(frozen=True)
class _Sighting:
    """A pose from which a reflector was found.

    Attributes:
        pose: the pose.
        j4_deg: middle of the return window.
    """

    pose: SearchPose
    j4_deg: float

    @property
    def offset_deg(self) -> float:
        """What the rough aim was wrong by, -180...180."""
        return (self.j4_deg - self.pose.j4_deg + 180.0) % 360.0 - 180.0


class SearchParams(BaseModel):
    """What may be chosen for a search."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    poses: int = Field(8, ge=4, le=40, description="poses for each reflector")
    half_range_deg: float = Field(6.0, gt=0.0, le=45.0, description="first scan to either side, deg")
    rough_place_mm: float = Field(20.0, gt=0.0, le=200.0, description="how far off a rough place may be, mm")


class ReflectorSearch:
    """Turns J4 at poses spread over the workspace until the beam comes back, then solves Eq. 2 for all."""

    name = "reflector-search"
    title = "Reflector search"
    needs_aim = False
    needs_tracker = False
    params_type = SearchParams

    def plan(self, bench: Bench, params: SearchParams) -> SearchPlan:
        """Plan the search; see plan_search."""
        return plan_search(bench, params.poses, params.half_range_deg, params.rough_place_mm)

    async def run(self, ctx: Context, plan: SearchPlan) -> None:
        """Search for all reflectors.

        Args:
            ctx: the bench.
            plan: what plan_search returned.

        Raises:
            ReflectorNotFoundError: too few sightings, or an aim that would not hold over the plan.
        """
        sightings: list[_Sighting] = []
        for number, pose in enumerate(plan.poses):
            found = await _sight(ctx, plan, pose, number, sightings)
            if found is not None:
                sightings.append(found)
            ctx.progress(number + 1, len(plan.poses), f"search {pose.reflector.name}")
        await ctx.step("solve", "Eq. 2 for all reflectors", lambda: _solve(ctx, plan, sightings))

    async def teardown(self, ctx: Context) -> None:
        """Leave the arm where it stands."""


async def _sight(
    ctx: Context, plan: SearchPlan, pose: SearchPose, number: int, known: list[_Sighting]
) -> _Sighting | None:
    """Look for a reflector from one pose."""
    step_id = f"sight/{pose.reflector.name}/{number:02d}"
    title = f"{pose.reflector.name}: look from θ1 {pose.theta1_deg:g}°, θ2 {pose.theta2_deg:g}°"
    result = await ctx.step(step_id, title, lambda: _look(ctx, plan, pose, known))
    return _Sighting(pose, _number(result["j4_deg"])) if result["found"] else None


async def _look(ctx: Context, plan: SearchPlan, pose: SearchPose, known: list[_Sighting]) -> Row:
    bench = plan.bench
    same = [sighting.offset_deg for sighting in known if sighting.pose.reflector == pose.reflector]
    expected = same or [sighting.offset_deg for sighting in known] or [0.0]
    half_range = plan.later_half_range_deg if known else plan.half_range_deg
    aim_deg = _on_a_branch(pose.j4_deg + sum(expected) / len(expected), bench.arm.j4_limits_deg)
    start = (pose.theta1_deg, pose.theta2_deg, bench.arm.j3_mm, aim_deg)
    half_window = half_window_deg(bench.optics.acceptance_mm, pose.beam_mm)
    window = await find_return(ctx, start, half_range, half_window, bench.arm.j4_limits_deg)
    if window is None:
        await ctx.warn(
            f"reflector {pose.reflector.name} not found within ±{half_range:g}° of J4 = {start[3]:.2f}° at "
            f"θ1 = {pose.theta1_deg:g}°, θ2 = {pose.theta2_deg:g}°: check that the beam is free, and the rough "
            "place and theta40_deg in the cell file"
        )
        return {"found": False}
    row: Row = {
        "reflector": pose.reflector.name,
        "theta1_deg": pose.theta1_deg,
        "theta2_deg": pose.theta2_deg,
        "j4_deg": window.centre_deg,
        "lower_deg": window.lower_deg,
        "upper_deg": window.upper_deg,
        "signal": window.signal,
    }
    ctx.record("search", row)
    return {"found": True, "j4_deg": window.centre_deg}


def _on_a_branch(j4_deg: float, limits_deg: tuple[float, float]) -> float:
    """Return J4 by whole turns inside its limits; unchanged where none fits, and the scan starts beside it."""
    low, high = limits_deg
    fitting = [j4_deg + turn for turn in (0.0, 360.0, -360.0) if low <= j4_deg + turn <= high]
    return fitting[0] if fitting else j4_deg


async def _solve(ctx: Context, plan: SearchPlan, sightings: list[_Sighting]) -> Row:
    bench = plan.bench
    _require_sightings(plan, sightings)
    rough = np.array([reflector.xy_mm for reflector in plan.reflectors])
    start = math.radians(bench.optics.theta40_deg)
    try:
        found = locate_reflectors(
            _table(plan, sightings), bench.arm.link1_mm, bench.arm.link2_mm, rough, start
        )
    except CalibrationError as error:
        raise ReflectorNotFoundError(str(error)) from error
    aim = [_worst_aim_mm(plan, found, index) for index in range(len(plan.reflectors))]
    await _require_aim(ctx, plan, aim)
    return _result(plan, found, aim)


def _table(plan: SearchPlan, sightings: list[_Sighting]) -> Sightings:
    rows = np.deg2rad([[s.pose.theta1_deg, s.pose.theta2_deg, s.j4_deg] for s in sightings])
    index = np.array([plan.reflectors.index(s.pose.reflector) for s in sightings], dtype=np.int64)
    return Sightings(rows[:, 0], rows[:, 1], rows[:, 2], index)


def _worst_aim_mm(plan: SearchPlan, found: SearchResult, index: int) -> float:
    """Return the largest standard uncertainty of the beam's place over the commands that see the reflector."""
    return float(found.aim_uncertainty_mm(plan.command_positions_mm[index], index).max())


def _require_sightings(plan: SearchPlan, sightings: list[_Sighting]) -> None:
    for reflector in plan.reflectors:
        count = sum(sighting.pose.reflector == reflector for sighting in sightings)
        if count < _FEWEST_SIGHTINGS:
            raise ReflectorNotFoundError(
                f"reflector {reflector.name} was found from {count} pose(s), {_FEWEST_SIGHTINGS} are needed: check "
                "that it stands where the cell file says, that the beam is level and free, or widen "
                f"half_range_deg (now {plan.half_range_deg:g}°)"
            )


async def _require_aim(ctx: Context, plan: SearchPlan, aim_mm: list[float]) -> None:
    optics = plan.bench.optics
    for reflector, uncertainty in zip(plan.reflectors, aim_mm, strict=True):
        if _COVERAGE * uncertainty + optics.max_miss_mm > optics.acceptance_mm:
            raise ReflectorNotFoundError(
                f"the aim at reflector {reflector.name} is known to {uncertainty:.2f} mm only (k = 1); with the "
                f"plan's miss of {optics.max_miss_mm:g} mm the beam would leave the acceptance of "
                f"{optics.acceptance_mm:g} mm: search from more poses (param poses) or lower max_miss_mm"
            )
    worst = max(aim_mm)
    await ctx.event("aim", worst_uncertainty_mm=worst, acceptance_mm=optics.acceptance_mm)


def _result(plan: SearchPlan, found: SearchResult, aim_mm: list[float]) -> Row:
    rms = math.degrees(float(np.sqrt(np.mean(found.residuals_rad**2))))
    places: list[Json] = [
        {
            "name": reflector.name,
            "x_mm": float(found.reflectors_mm[i, 0]),
            "y_mm": float(found.reflectors_mm[i, 1]),
            "u_x_mm": float(found.u_reflectors_mm[i, 0]),
            "u_y_mm": float(found.u_reflectors_mm[i, 1]),
            "u_aim_mm": aim_mm[i],
        }
        for i, reflector in enumerate(plan.reflectors)
    ]
    return {
        "reflectors": places,
        "theta40_deg": math.degrees(found.theta40_rad),
        "u_theta40_deg": math.degrees(found.u_theta40_rad),
        "rms_deg": rms,
    }


def _number(value: object) -> float:
    if isinstance(value, (int, float)):
        return float(value)
    raise TypeError(f"a stored step result holds {value!r} where an angle belongs")
