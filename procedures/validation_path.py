"""A straight path both ways, located by an independent instrument (Sec. 4.3 of the SCARA paper)."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from calibration.kinematics import Hand, inverse
from procedures.bench import Bench
from procedures.context import Context, Row
from procedures.devices import Joints
from procedures.errors import PlanError, PlanLimitError
from procedures.free_way import require_free_way
from procedures.motion_time import move_time_s

_REST_RAD = 1e-9
"""Changes below this are no motion."""


@dataclass(frozen=True)
class PathPoint:
    """A command on the path.

    Attributes:
        x_mm: command position.
        y_mm: command position.
        theta1_deg: J1 of the nominal arm.
        theta2_deg: J2 of the nominal arm.
        direction1: sign of the last change of J1.
        direction2: sign of the last change of J2.
    """

    x_mm: float
    y_mm: float
    theta1_deg: float
    theta2_deg: float
    direction1: int
    direction2: int


@dataclass(frozen=True)
class PathPlan:
    """The whole path.

    Attributes:
        bench: what it was made from.
        run_in: joint target from which the first point is approached.
        points: commands in order, there and back.
        passes: how often the whole way is driven.
        duration_s: expected time of all passes.
    """

    bench: Bench
    run_in: Joints
    points: tuple[PathPoint, ...]
    passes: int
    duration_s: float


def plan_path(
    bench: Bench,
    x_mm: float = 200.0,
    y_from_mm: float = -500.0,
    y_to_mm: float = 500.0,
    step_mm: float = 10.0,
    hand: Hand = "right",
    passes: int = 1,
) -> PathPlan:
    """Plan the paper's path, there and back.

    Args:
        bench: nominal arm and limits.
        x_mm: where the path runs.
        y_from_mm: first end.
        y_to_mm: other end.
        step_mm: largest distance between points.
        hand: "right" has θ2 >= 0.
        passes: how often the whole way is driven.

    Raises:
        OutOfReachError: a point of the path is out of reach.
        PlanLimitError: a joint leaves its limits.
        PlanError: both ends of the path are the same.
    """
    if y_from_mm == y_to_mm:
        raise PlanError(f"the path begins and ends at y = {y_from_mm:g} mm; give two different ends")
    count = max(2, int(np.ceil(abs(y_to_mm - y_from_mm) / step_mm)) + 1)
    there = np.linspace(y_from_mm, y_to_mm, count)
    y = np.concatenate([there, there[::-1]])
    xy = np.column_stack([np.full(y.size, x_mm), y])
    theta = np.column_stack(inverse(xy, bench.arm.link1_mm, bench.arm.link2_mm, hand))
    theta[:, 0] = np.unwrap(theta[:, 0])
    directions = np.column_stack(
        [states_of_approach(theta[:, n], _first_sign(theta[:, n])) for n in range(2)]
    )
    run_in = np.rad2deg(theta[0]) - bench.take_up_deg * directions[0]
    _require_limits(np.vstack([run_in, np.rad2deg(theta)]), bench)
    require_free_way(np.vstack([run_in, np.rad2deg(theta)]), bench)
    points = tuple(
        PathPoint(float(p[0]), float(p[1]), float(t[0]), float(t[1]), int(d[0]), int(d[1]))
        for p, t, d in zip(xy, np.rad2deg(theta), directions, strict=True)
    )
    start: Joints = (float(run_in[0]), float(run_in[1]), bench.arm.j3_mm, 0.0)
    return PathPlan(bench, start, points, passes, passes * _duration_s(np.rad2deg(theta), bench))


def states_of_approach(theta_rad: NDArray[np.float64], first: int) -> NDArray[np.int64]:
    """Return the state of approach of a joint along a path: the sign of its last change, shape (n,).

    Args:
        theta_rad: command angles in order, rad, shape (n,).
        first: state at the first row, 1 or -1.
    """
    change = np.diff(theta_rad)
    signs = np.append(first, np.where(np.abs(change) > _REST_RAD, np.sign(change), 0)).astype(np.int64)
    last = np.maximum.accumulate(np.where(signs != 0, np.arange(signs.size), 0))
    return signs[last]


def _first_sign(theta_rad: NDArray[np.float64]) -> int:
    moving = np.flatnonzero(np.abs(np.diff(theta_rad)) > _REST_RAD)
    return 1 if not moving.size or np.diff(theta_rad)[moving[0]] > 0 else -1


def _require_limits(theta_deg: NDArray[np.float64], bench: Bench) -> None:
    for joint, angles, (low, high) in (
        ("J1", theta_deg[:, 0], bench.arm.j1_limits_deg),
        ("J2", theta_deg[:, 1], bench.arm.j2_limits_deg),
    ):
        worst = angles[np.argmax(np.abs(angles - 0.5 * (low + high)))]
        if not low <= worst <= high:
            raise PlanLimitError(
                f"the path needs {joint} = {worst:.2f}°, outside its limits {low:g}°…{high:g}°: "
                "choose another path or the other hand"
            )


def _duration_s(theta_deg: NDArray[np.float64], bench: Bench) -> float:
    travel = np.column_stack([np.diff(theta_deg, axis=0), np.zeros(len(theta_deg) - 1)])
    rest = bench.timing.settle_time_s * len(theta_deg)
    return float(move_time_s(bench.arm, travel).sum()) + rest


class PathParams(BaseModel):
    """What may be chosen for a validation path."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    # The bounds hold for any arm; whether this one reaches is found out by the plan.
    x_mm: float = Field(200.0, ge=-5000.0, le=5000.0, description="where the path runs, mm")
    y_from_mm: float = Field(-500.0, ge=-5000.0, le=5000.0, description="first end, mm")
    y_to_mm: float = Field(500.0, ge=-5000.0, le=5000.0, description="other end, mm")
    step_mm: float = Field(10.0, ge=0.1, le=500.0, description="largest distance between points, mm")
    hand: Hand = Field("right", description="right has θ2 >= 0")
    passes: int = Field(1, ge=1, le=100, description="how often the whole way is driven")


class ValidationPath:
    """Drives the path and records where an independent instrument sees the arm."""

    name = "validation-path"
    title = "Validation path"
    needs_aim = False
    needs_tracker = True
    params_type = PathParams

    def plan(self, bench: Bench, params: PathParams) -> PathPlan:
        """Plan the path; see plan_path."""
        return plan_path(bench, **params.model_dump())

    async def run(self, ctx: Context, plan: PathPlan) -> None:
        """Drive and locate.

        Args:
            ctx: the bench; it has an independent instrument.
            plan: what plan_path returned.
        """
        total = plan.passes * len(plan.points)
        for pass_number in range(plan.passes):
            title = f"pass {pass_number + 1}: approach the first point"
            await ctx.step(f"run-in/{pass_number}", title, lambda: _run_in(ctx, plan))
            for number, point in enumerate(plan.points):
                title = f"x {point.x_mm:g} mm, y {point.y_mm:g} mm"
                step_id = f"path/{pass_number}/{number:04d}"
                await ctx.step(step_id, title, partial(_locate, ctx, plan, point, pass_number))
                done = pass_number * len(plan.points) + number + 1
                ctx.progress(done, total, f"path point {done}/{total}")

    async def teardown(self, ctx: Context) -> None:
        """Leave the arm where it stands."""


async def _run_in(ctx: Context, plan: PathPlan) -> Row:
    await ctx.move(plan.run_in)
    return {}


async def _locate(ctx: Context, plan: PathPlan, point: PathPoint, pass_number: int) -> Row:
    await ctx.move((point.theta1_deg, point.theta2_deg, plan.bench.arm.j3_mm, 0.0))
    found = await ctx.locate(plan.bench.timing.settle_time_s)
    ctx.record(
        "path",
        {
            "x_mm": point.x_mm,
            "y_mm": point.y_mm,
            "theta1_deg": point.theta1_deg,
            "theta2_deg": point.theta2_deg,
            "direction1": point.direction1,
            "direction2": point.direction2,
            "x_meas_mm": found.x_mm,
            "y_meas_mm": found.y_mm,
            "u_mm": found.u_mm,
            "pass_number": pass_number,
        },
    )
    return {"x_meas_mm": found.x_mm, "y_meas_mm": found.y_mm}
