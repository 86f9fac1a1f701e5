"""A path of joint commands that are driven as they stand, each from its side: a corrected path."""

from collections.abc import Sequence

import numpy as np

from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.motion.clear_way import require_clear_way
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.motion.approach import Command, Waypoint, with_take_up
from catseye.procedures.scara.path.path_plan import (
    Instrument,
    PathPlan,
    chosen_instrument,
    path_duration_s,
    require_path_limits,
)
from catseye.procedures.scara.path.tracked_path import PathPoint


def plan_joint_rows(
    bench: ScaraBench,
    rows: Sequence[Sequence[float]],
    passes: int = 1,
    instrument: Instrument | None = None,
    hold_time_s: float = 2.0,
    confirm_each: bool = False,
) -> PathPlan:
    """Plan a path of joint commands; where a side of approach asks for it, a joint overshoots and comes back.

    Args:
        rows: where the arm shall stand, x and y in mm, J1 and J2 in deg, states of approach, 1 or -1; in order.
        instrument: who measures; not the interferometer.
        hold_time_s: standstill at a point that is measured for a file.
        confirm_each: the operator confirms each of those points.

    Raises:
        PlanLimitError: a command or a take-up leaves the limits of a joint.
        PlanError: the interferometer shall measure, or something stands in the way.
    """
    chosen = chosen_instrument(bench, instrument)
    if chosen == "interferometer":
        raise PlanError(
            "a path of joint commands (joints=FILE) is measured by a tracker, or with --param instrument=file: the "
            "beam cannot follow its take-ups"
        )
    points = tuple(PathPoint(x, y, one, two, int(s1), int(s2)) for x, y, one, two, s1, s2 in rows)
    commands = tuple(
        Command(index, point.theta1_deg, point.theta2_deg, point.direction1, point.direction2)
        for index, point in enumerate(points)
    )
    stops = with_take_up(commands, bench.take_up_deg)
    theta = np.array([[stop.theta1_deg, stop.theta2_deg] for stop in stops])
    require_path_limits(theta, bench)
    # Every pass begins with the take-up of the first row.
    way = [(stop.theta1_deg, stop.theta2_deg, bench.j3_mm, 0.0) for stop in (*stops, stops[0])]
    require_clear_way(way, bench)
    rest_s = hold_time_s if chosen == "file" else bench.timing.settle_time_s
    duration_s = passes * path_duration_s(theta, rest_s, bench)
    first, *_ = come_from = _come_from(stops)
    assert first is not None  # noqa: S101  # nothing is known of the way to the first row: it always has a take-up
    return PathPlan(
        bench,
        (*first, bench.j3_mm, 0.0),
        points,
        passes,
        duration_s,
        chosen,
        hold_time_s=hold_time_s,
        confirm_each=confirm_each,
        # The run-in is the take-up of the first row.
        come_from=(None, *come_from[1:]),
    )


def _come_from(stops: tuple[Waypoint, ...]) -> list[tuple[float, float] | None]:
    """Return the take-up position before each row, None where there is none."""
    found: list[tuple[float, float] | None] = []
    before: tuple[float, float] | None = None
    for stop in stops:
        if stop.command is None:
            before = (stop.theta1_deg, stop.theta2_deg)
            continue
        found.append(before)
        before = None
    return found
