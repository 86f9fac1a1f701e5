"""A path that a file gives: in one line or several, each entered from its own side."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.scara.planar import Hand, forward, inverse
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.errors import PlanError, PlanLimitError
from catseye.procedures.kit.motion.clear_way import require_clear_way
from catseye.procedures.kit.motion.motion_time import way_time_s
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.motion.approach import Command, with_take_up
from catseye.procedures.scara.motion.entry import free_way
from catseye.procedures.scara.motion.visits import require_clear_visits
from catseye.procedures.scara.path.path_plan import (
    Instrument,
    PathPlan,
    chosen_instrument,
    line_states,
    require_path_limits,
    unclipped,
)
from catseye.procedures.scara.path.reach import likely_unit, unit_text
from catseye.procedures.scara.path.rows import JointRow, PathRow, line_of
from catseye.procedures.scara.path.tracked_path import PathPoint, plan_tracked_path
from catseye.procedures.scara.path_lines import scattered, scattered_text, stretches

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class GivenPoint(PathPoint):
    """A command of a path that a file gives.

    Attributes:
        line: that the point belongs to; None for a path that names none.
        j3_mm: J3; None for the height of the bench.
        j4_deg: J4; None for 0, or where the beam's aim says it.
    """

    line: int | None = None
    j3_mm: float | None = None
    j4_deg: float | None = None


@dataclass(frozen=True)
class GivenPlan(PathPlan):
    """The whole of such a path.

    Attributes:
        entered: points at which a further line begins: the way to their take-up is led around what stands in it.
    """

    entered: frozenset[int] = frozenset()


def plan_given_path(
    bench: ScaraBench,
    rows: Sequence[PathRow],
    hand: Hand = "right",
    passes: int = 1,
    instrument: Instrument | None = None,
    reflector: str = "",
    hold_time_s: float = 2.0,
    confirm_each: bool = False,
) -> PathPlan:
    """Plan a path of wished places, or of joint commands; each line is entered in its own direction.

    Args:
        rows: in order.
        hand: of places: "right" has θ2 >= 0.
        instrument: who measures; None takes the cell's tracker, or the interferometer without one.
        reflector: that the interferometer measures to; empty for the one that sees most of the path.
        hold_time_s: standstill at a point that is measured for a file.
        confirm_each: the operator confirms each of those points.

    Raises:
        OutOfReachError: a place is out of reach.
        PlanLimitError: a joint leaves its limits.
        PlanError: rows of one line do not stand together, or of two forms are mixed; the positions are in another
            unit; something stands in the way; the instrument cannot measure the path.
    """
    line = _lines(rows)
    if any((row.x_mm is None) != (rows[0].x_mm is None) for row in rows):
        raise PlanError("joint commands and places stand in one path: give each a file of its own")
    chosen = chosen_instrument(bench, instrument)
    given = rows[0].x_mm is None
    points = _commanded(rows, line, bench) if given else _wished(rows, line, bench, hand)
    if chosen == "interferometer":
        return _tracked(points, line, bench, passes, reflector, given=given)
    return _driven(points, line, bench, passes, chosen, hold_time_s, confirm_each, taken_up=given)


def plan_joint_rows(
    bench: ScaraBench,
    rows: Sequence[JointRow],
    passes: int = 1,
    instrument: Instrument | None = None,
    hold_time_s: float = 2.0,
    confirm_each: bool = False,
) -> PathPlan:
    """Plan a path of joint commands; where a side of approach asks for it, a joint overshoots and comes back.

    Args:
        rows: where the arm shall stand, and how it gets there; in order.
        instrument: who measures; not the interferometer.
        hold_time_s: standstill at a point that is measured for a file.
        confirm_each: the operator confirms each of those points.

    Raises:
        PlanLimitError: a command or a take-up leaves the limits of a joint.
        PlanError: the interferometer shall measure, something stands in the way, or rows of one line do not stand
            together.
    """
    chosen = chosen_instrument(bench, instrument)
    if chosen == "interferometer":
        raise _beyond_the_beam()
    points = tuple(GivenPoint(**row.model_dump()) for row in rows)
    return _driven(points, _lines(rows), bench, passes, chosen, hold_time_s, confirm_each, taken_up=True)


def _lines(rows: Sequence[PathRow] | Sequence[JointRow]) -> Ints:
    line = np.array(line_of(rows), dtype=np.int64)
    if (row := scattered(line)) is not None:
        raise PlanError(f"row {row + 1} of the path: {scattered_text(int(line[row]))}")
    return line


def _beyond_the_beam() -> PlanError:
    return PlanError(
        "a path of joint commands is measured by a tracker, or with --param instrument=file: the beam cannot follow "
        "its take-ups"
    )


def _wished(rows: Sequence[PathRow], line: Ints, bench: ScaraBench, hand: Hand) -> tuple[PathPoint, ...]:
    place = np.array([[row.x_mm, row.y_mm] for row in rows], dtype=np.float64)
    links_mm = bench.link1_mm, bench.link2_mm
    if unit := likely_unit(place, links_mm, hand):
        raise PlanError(unit_text("of the path", unit))
    theta = np.column_stack(inverse(place, *links_mm, hand))
    states = np.empty(theta.shape, dtype=np.int64)
    for own in stretches(line):
        theta[own, 0] = np.unwrap(theta[own, 0])
        states[own] = line_states(theta[own])
    return _points(rows, place, np.rad2deg(theta), states, line, bench)


def _commanded(rows: Sequence[PathRow], line: Ints, bench: ScaraBench) -> tuple[PathPoint, ...]:
    theta = np.array([[row.theta1_deg, row.theta2_deg] for row in rows], dtype=np.float64)
    states = np.array([[row.direction1, row.direction2] for row in rows], dtype=np.int64)
    angles = np.deg2rad(theta)
    place = forward(angles[:, 0], angles[:, 1], bench.link1_mm, bench.link2_mm)
    return _points(rows, place, theta, states, line, bench)


def _points(
    rows: Sequence[PathRow], place: Floats, theta: Floats, states: Ints, line: Ints, bench: ScaraBench
) -> tuple[PathPoint, ...]:
    """Return the points with the J3 and J4 that keep height and orientation of the tool."""
    zero, j3, j4 = bench.tool_zero, [None] * len(rows), [None] * len(rows)
    if rows[0].z_mm is not None:
        j3 = zero.j3_mm(_stated(rows, "z_mm")).tolist()
    if rows[0].c_deg is not None:
        j4 = zero.j4_deg(_stated(rows, "c_deg"), theta, line, bench.j4_limits_deg).tolist()
    return tuple(
        GivenPoint(x_mm, y_mm, one, two, state1, state2, row.line, height, turned)
        for row, (x_mm, y_mm), (one, two), (state1, state2), height, turned in zip(
            rows, place.tolist(), theta.tolist(), states.tolist(), j3, j4, strict=True
        )
    )


def _stated(rows: Sequence[PathRow], name: str) -> Floats:
    values = [getattr(row, name) for row in rows]
    if None in values:
        raise PlanError(
            f"row {values.index(None) + 1} of the path has no {name}, and others have: state it for all"
        )
    return np.array(values, dtype=np.float64)


def _driven(
    points: tuple[PathPoint, ...],
    line: Ints,
    bench: ScaraBench,
    passes: int,
    chosen: Instrument,
    hold_time_s: float,
    confirm_each: bool,
    *,
    taken_up: bool,
) -> PathPlan:
    """Plan points that an independent instrument measures.

    Args:
        taken_up: within a line, too, a joint overshoots where its side asks for it; else only lines are entered so.
    """
    come_from: list[Pose | None] = []
    ways: list[list[Pose]] = []
    for own in stretches(line):
        before = _come_from(points[own], bench, taken_up=taken_up)
        come_from += before
        ways.append(
            [
                pose
                for start, point in zip(before, points[own], strict=True)
                for pose in (start, point.pose(bench))
                if pose
            ]
        )
    require_joints([pose for way in ways for pose in way], bench)
    for way in ways:
        require_clear_way(way, bench)
    rest_s = hold_time_s if chosen == "file" else bench.timing.settle_time_s
    between = _between(ways if passes == 1 else [*ways, ways[0]], line, bench)
    moving_s = sum(way_time_s(bench.arm, np.array(way)) for way in (*ways, *between))
    run_in = come_from[0]
    assert run_in is not None  # noqa: S101  # every line is entered from somewhere
    starts = [own.start for own in stretches(line)]
    return GivenPlan(
        bench,
        run_in,
        points,
        passes,
        passes * (moving_s + rest_s * len(points)),
        chosen,
        hold_time_s=hold_time_s,
        confirm_each=confirm_each,
        # The run-in is the take-up of the first row.
        come_from=(None, *come_from[1:]),
        entered=frozenset(starts[1:]),
    )


def _come_from(points: Sequence[PathPoint], bench: ScaraBench, *, taken_up: bool) -> list[Pose | None]:
    """Return the take-up before each point of a line, None where there is none; before the first there always is."""
    if not taken_up:
        one, two, *_ = unclipped(points[0], bench)
        first = points[0].pose(bench)
        return [(one, two, first[2], first[3]), *[None] * (len(points) - 1)]
    commands = tuple(
        Command(index, point.theta1_deg, point.theta2_deg, point.direction1, point.direction2)
        for index, point in enumerate(points)
    )
    found: list[Pose | None] = []
    before: tuple[float, float] | None = None
    for stop in with_take_up(commands, bench.take_up_deg):
        if stop.command is None:
            before = (stop.theta1_deg, stop.theta2_deg)
            continue
        _, _, height, turned = points[stop.command.index].pose(bench)
        found.append(None if before is None else (*before, height, turned))
        before = None
    return found


def _between(ways: Sequence[Sequence[Pose]], line: Ints, bench: ScaraBench) -> list[list[Pose]]:
    """Return the way from the end of each line to where the next one is entered.

    Raises:
        PlanError: there is none; names both lines.
    """
    numbers = [int(line[own.start]) for own in stretches(line)]
    found: list[list[Pose]] = []
    for place, (way, following) in enumerate(pairwise(ways)):
        free = free_way(way[-1], following[0], bench)
        if isinstance(free, str):
            left, entered = numbers[place], numbers[(place + 1) % len(numbers)]
            raise PlanError(
                f"from the end of line {left} to the beginning of line {entered}: {free}. Put the lines in another "
                "order, turn one round, or choose the other hand"
            )
        found.append([way[-1], *free])
    return found


def require_joints(poses: Sequence[Pose], bench: ScaraBench) -> None:
    """Refuse targets outside the limits of any joint.

    Raises:
        PlanLimitError: names the joint, the farthest target and the remedy.
    """
    require_path_limits(np.array(poses)[:, :2], bench)
    remedies = {
        2: "choose another z_mm, or widen j3_range_mm in [robot] of the cell file",
        3: "choose another c_deg, or split the line in two",
    }
    for joint, remedy in remedies.items():
        axis = bench.arm.axes[joint]
        worst = max((pose[joint] for pose in poses), key=lambda value: abs(value - 0.5 * sum(axis.range)))
        if not axis.allows(worst):
            raise PlanLimitError(
                f"the path needs {axis.text(worst)}, outside its limits {axis.low:g}…{axis.high:g}: {remedy}"
            )


def _tracked(
    points: tuple[PathPoint, ...], line: Ints, bench: ScaraBench, passes: int, reflector: str, *, given: bool
) -> PathPlan:
    """Plan points that the interferometer measures: the beam says where J4 stands, and how high J3."""
    if given:
        raise _beyond_the_beam()
    if any(point.j4_deg is not None for point in points):
        raise PlanError(
            "the interferometer turns J4 to aim, so that c_deg cannot be kept: omit it, or measure with a "
            "tracker or --param instrument=file"
        )
    if any(point.j3_mm not in (None, bench.j3_mm) for point in points):
        raise PlanError(
            f"the beam is level at j3_mm = {bench.j3_mm:g} mm: omit z_mm, or measure with a tracker or --param "
            "instrument=file"
        )
    entries: dict[int, Pose] = {
        own.start: (*unclipped(points[own.start], bench), bench.j3_mm, 0.0) for own in stretches(line)
    }
    run_in = entries.pop(0)
    require_path_limits(
        np.array([*(unclipped(p, bench) for p in points), *((p.theta1_deg, p.theta2_deg) for p in points)]),
        bench,
    )
    tracked = plan_tracked_path(run_in, points, passes, bench, reflector, entries)
    require_clear_visits(tracked.visits, bench)
    return PathPlan(bench, run_in, points, passes, tracked.duration_s, "interferometer", tracked)
