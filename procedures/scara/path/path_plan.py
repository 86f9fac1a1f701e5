"""The commands of a straight path there and back, and how they are driven."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.scara.planar import Hand, inverse
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.errors import PlanError, PlanLimitError
from catseye.procedures.kit.motion.clear_way import require_clear_way
from catseye.procedures.kit.motion.motion_time import move_time_s
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.motion.visits import require_clear_visits
from catseye.procedures.scara.path.instrument_file import PositionsMapping
from catseye.procedures.scara.path.tracked_path import PathPoint, TrackedPath, plan_tracked_path

_REST_RAD = 1e-9
"""Changes below this are no motion."""

Instrument = Literal["tracker", "interferometer", "file"]
"""Who measures: a tracker that the program reads, the interferometer on the arm, or an instrument that hands in a
file afterwards."""


@dataclass(frozen=True)
class PathPlan:
    """The whole path.

    Attributes:
        bench: what it was made from.
        run_in: joint target from which the first point is approached.
        points: commands in order, there and back.
        passes: how often the whole way is driven.
        duration_s: expected time of all passes.
        instrument: who measures.
        tracked: how the beam follows a reflector along the way; None unless the interferometer measures.
        hold_time_s: how long the arm stands still at a point that is measured for a file.
        confirm_each: the operator confirms each of those points.
        come_from: the take-up before each point, None where there is none; empty for a path without any.
        mapping: how the file is read that the instrument hands in; None for a measured CSV.
    """

    bench: ScaraBench
    run_in: Pose
    points: tuple[PathPoint, ...]
    passes: int
    duration_s: float
    instrument: Instrument = "tracker"
    tracked: TrackedPath | None = None
    hold_time_s: float = 0.0
    confirm_each: bool = False
    come_from: tuple[Pose | None, ...] = ()
    mapping: PositionsMapping | None = None

    @property
    def entered(self) -> frozenset[int]:
        """Points at which a further line begins: the way to their take-up is led around what stands in it."""
        return frozenset()


def plan_path(
    bench: ScaraBench,
    x_mm: float = 200.0,
    y_from_mm: float = -500.0,
    y_to_mm: float = 500.0,
    step_mm: float = 10.0,
    hand: Hand = "right",
    passes: int = 1,
    instrument: Instrument | None = None,
    reflector: str = "",
    hold_time_s: float = 2.0,
    confirm_each: bool = False,
) -> PathPlan:
    """Plan the paper's path, there and back.

    Args:
        x_mm: where the path runs.
        y_from_mm: first end.
        y_to_mm: other end.
        step_mm: largest distance between points.
        hand: "right" has θ2 >= 0.
        instrument: who measures; None takes the cell's tracker, or the interferometer without one.
        reflector: that the interferometer measures to; empty for the one that sees most of the path.
        hold_time_s: standstill at a point that is measured for a file.
        confirm_each: the operator confirms each of those points.

    Raises:
        OutOfReachError: a point of the path is out of reach.
        PlanLimitError: a joint leaves its limits.
        PlanError: both ends of the path are the same; no reflector sees enough of it; the cell has no tracker.
    """
    chosen = chosen_instrument(bench, instrument)
    points = path_points(bench, x_mm, (y_from_mm, y_to_mm), step_mm, hand)
    theta = np.array([[point.theta1_deg, point.theta2_deg] for point in points])
    run_in: Pose = (*unclipped(points[0], bench), bench.j3_mm, 0.0)
    require_path_limits(np.vstack([run_in[:2], theta]), bench)
    if chosen == "interferometer":
        require_path_limits(np.array([unclipped(point, bench) for point in points]), bench)
        tracked = plan_tracked_path(run_in, points, passes, bench, reflector)
        require_clear_visits(tracked.visits, bench)
        return PathPlan(bench, run_in, points, passes, tracked.duration_s, chosen, tracked)
    way = [run_in, *((p.theta1_deg, p.theta2_deg, bench.j3_mm, 0.0) for p in points)]
    # Every pass begins with the run-in.
    require_clear_way([*way, run_in], bench)
    hold_s = hold_time_s if chosen == "file" else bench.timing.settle_time_s
    duration_s = passes * path_duration_s(theta, hold_s, bench)
    return PathPlan(
        bench, run_in, points, passes, duration_s, chosen, hold_time_s=hold_time_s, confirm_each=confirm_each
    )


def path_points(
    bench: ScaraBench, x_mm: float, ends_mm: tuple[float, float], step_mm: float, hand: Hand
) -> tuple[PathPoint, ...]:
    """Return the commands of a path along y, there and back.

    Args:
        x_mm: where the path runs.
        ends_mm: y at both ends.
        step_mm: largest distance between points.
        hand: "right" has θ2 >= 0.

    Raises:
        OutOfReachError: a point of the path is out of reach.
        PlanError: both ends of the path are the same.
    """
    first_mm, last_mm = ends_mm
    if first_mm == last_mm:
        raise PlanError(f"the path begins and ends at y = {first_mm:g} mm; give two different ends")
    count = max(2, int(np.ceil(abs(last_mm - first_mm) / step_mm)) + 1)
    there = np.linspace(first_mm, last_mm, count)
    y = np.concatenate([there, there[::-1]])
    xy = np.column_stack([np.full(y.size, x_mm), y])
    theta = np.column_stack(inverse(xy, bench.link1_mm, bench.link2_mm, hand))
    theta[:, 0] = np.unwrap(theta[:, 0])
    return tuple(
        PathPoint(float(p[0]), float(p[1]), float(t[0]), float(t[1]), int(d[0]), int(d[1]))
        for p, t, d in zip(xy, np.rad2deg(theta), line_states(theta), strict=True)
    )


def line_states(theta_rad: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the states of approach of a line that is entered in its own direction, shape (n, 2).

    Args:
        theta_rad: J1 and J2 along it, rad, shape (n, 2).
    """
    return np.column_stack([states_of_approach(own, _first_sign(own)) for own in theta_rad.T])


def take_up_of(point: PathPoint, bench: ScaraBench) -> Pose:
    """Return where a point is approached from with its directions; at a limit of a joint the way is shorter."""
    limits = (bench.j1_limits_deg, bench.j2_limits_deg)
    one, two = (
        min(max(start, low), high) for start, (low, high) in zip(unclipped(point, bench), limits, strict=True)
    )
    return (one, two, *point.pose(bench)[2:])


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


def chosen_instrument(bench: ScaraBench, wanted: Instrument | None) -> Instrument:
    """Return who measures.

    Args:
        bench: says whether there is a tracker.
        wanted: by the operator; None for the cell's tracker, or the interferometer without one.

    Raises:
        PlanError: a tracker is wanted that the cell does not have.
    """
    if wanted is None:
        return "tracker" if bench.tracker else "interferometer"
    if wanted == "tracker" and not bench.tracker:
        raise PlanError(
            "the cell file has no [tracker]: add one, measure with --param instrument=interferometer, or hand in "
            "an instrument's CSV with --param instrument=file"
        )
    return wanted


def unclipped(point: PathPoint, bench: ScaraBench) -> tuple[float, float]:
    """Return J1 and J2 of the take-up before a point, whatever the limits are."""
    return (
        point.theta1_deg - point.direction1 * bench.take_up_deg,
        point.theta2_deg - point.direction2 * bench.take_up_deg,
    )


def _first_sign(theta_rad: NDArray[np.float64]) -> int:
    moving = np.flatnonzero(np.abs(np.diff(theta_rad)) > _REST_RAD)
    return 1 if not moving.size or np.diff(theta_rad)[moving[0]] > 0 else -1


def require_path_limits(theta_deg: NDArray[np.float64], bench: ScaraBench) -> None:
    """Refuse targets of J1 and J2, deg, shape (n, 2), outside their limits.

    Raises:
        PlanLimitError: names the joint and the farthest target.
    """
    for joint, angles, (low, high) in (
        ("J1", theta_deg[:, 0], bench.j1_limits_deg),
        ("J2", theta_deg[:, 1], bench.j2_limits_deg),
    ):
        worst = angles[np.argmax(np.abs(angles - 0.5 * (low + high)))]
        if not low <= worst <= high:
            raise PlanLimitError(
                f"the path needs {joint} = {worst:.2f}°, outside its limits {low:g}°…{high:g}°: "
                "choose another path or the other hand"
            )


def path_duration_s(theta_deg: NDArray[np.float64], rest_s: float, bench: ScaraBench) -> float:
    """Return the expected time of one pass, with a rest at each of n targets, deg, shape (n, 2)."""
    travel = np.column_stack([np.diff(theta_deg, axis=0), np.zeros((len(theta_deg) - 1, 2))])
    return float(move_time_s(bench.arm, travel).sum()) + rest_s * len(theta_deg)
