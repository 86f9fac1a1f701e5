"""The validation path: its commands, its directions, what is recorded."""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from catseye.calibration.scara.errors import OutOfReachError
from catseye.drivers.roles.tracker import Position
from catseye.procedures.kit.columns import Columns
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.errors import ArmMovedError, PlanError, PlanLimitError, TableFileError
from catseye.procedures.kit.motion.motion_time import move_time_s
from catseye.procedures.kit.records import Record
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.path.path_plan import PathPlan, plan_path, states_of_approach
from catseye.procedures.scara.path.validation_path import PathParams, ValidationPath
from tests.unit.procedures.benches import IdealContext, arm_xy, bench, scara_axes, with_axes


def test_the_papers_path_runs_there_and_back() -> None:
    plan = plan_path(bench())
    assert len(plan.points) == 202
    assert {point.x_mm for point in plan.points} == {200.0}
    y = [point.y_mm for point in plan.points]
    assert (y[0], y[100], y[101], y[201]) == (-500.0, 500.0, 500.0, -500.0)
    assert np.diff(y[:101]) == pytest.approx(np.full(100, 10.0))
    assert y[101:] == y[100::-1]


@pytest.mark.parametrize("hand", ["right", "left"])
def test_every_command_reaches_its_position_with_the_chosen_hand(hand: str) -> None:
    plan = ValidationPath().plan(bench(), PathParams.model_validate({"hand": hand}))
    for point in plan.points:
        assert arm_xy(point.theta1_deg, point.theta2_deg) == pytest.approx((point.x_mm, point.y_mm), abs=1e-9)
        assert (point.theta2_deg >= 0.0) == (hand == "right")


def directions_by_rule(angles: list[float], first: int) -> list[int]:
    """Return the sign of each change from the row before; no change keeps the state."""
    states = [first]
    for before, now in pairwise(angles):
        states.append(states[-1] if abs(now - before) < 1e-7 else (1 if now > before else -1))
    return states


def test_directions_follow_the_rule_of_the_path_file() -> None:
    plan = plan_path(bench())
    for angles, states in (
        ([p.theta1_deg for p in plan.points], [p.direction1 for p in plan.points]),
        ([p.theta2_deg for p in plan.points], [p.direction2 for p in plan.points]),
    ):
        assert states == directions_by_rule(angles, states[0])
        assert set(states) == {1, -1}


def test_a_joint_at_rest_keeps_its_state() -> None:
    angles = np.radians([0.0, 1.0, 1.0, 0.5, 0.5, 0.5, 0.75])
    assert states_of_approach(angles, 1).tolist() == [1, 1, 1, -1, -1, -1, 1]
    assert states_of_approach(angles[1:3], -1).tolist() == [-1, -1]


def test_the_run_in_gives_the_first_point_its_direction() -> None:
    plan = plan_path(bench())
    first = plan.points[0]
    for angle, run_in, state in (
        (first.theta1_deg, plan.run_in[0], first.direction1),
        (first.theta2_deg, plan.run_in[1], first.direction2),
    ):
        assert angle - run_in == pytest.approx(state * 1.0)
    assert plan.run_in[2:] == (12.5, 0.0)


def test_the_first_direction_is_that_of_the_first_motion() -> None:
    plan = plan_path(bench())
    assert plan.points[0].direction1 == (1 if plan.points[1].theta1_deg > plan.points[0].theta1_deg else -1)
    assert plan.points[0].direction2 == (1 if plan.points[1].theta2_deg > plan.points[0].theta2_deg else -1)


def test_a_path_behind_the_arm_has_no_full_turns() -> None:
    wide = with_axes(bench(), j1_deg=(-400.0, 400.0))
    plan = plan_path(wide, x_mm=-300.0, y_from_mm=-300.0, y_to_mm=300.0)
    steps = np.diff([point.theta1_deg for point in plan.points])
    assert float(np.abs(steps).max()) < 10.0


def test_a_point_out_of_reach_is_named() -> None:
    with pytest.raises(OutOfReachError, match=r"x = 200 mm, y = -600 mm\) is out of reach"):
        plan_path(bench(), y_from_mm=-600.0)
    with pytest.raises(OutOfReachError, match="radii from 100 to 550 mm"):
        plan_path(bench(), x_mm=10.0, y_from_mm=-80.0, y_to_mm=80.0)


def test_limits_violated_by_path_or_run_in_are_named() -> None:
    plan = plan_path(bench(), y_to_mm=-400.0)
    angles = [point.theta1_deg for point in plan.points]
    # Beyond the first point the limit leaves room for the path but not for the run-in.
    assert plan.points[0].direction1 == -1
    assert max(angles) == angles[0]
    tight = with_axes(bench(), j1_deg=(-170.0, angles[0] + 0.5))
    with pytest.raises(PlanLimitError, match=r"the path needs J1 = .*outside its limits.*the other hand"):
        plan_path(tight, y_to_mm=-400.0)
    folded = with_axes(bench(), j2_deg=(-100.0, 100.0))
    with pytest.raises(PlanLimitError, match="the path needs J2"):
        plan_path(folded)


def test_parameters_of_an_unplannable_path_are_refused() -> None:
    for values in (
        {"y_to_mm": 1e12},
        {"x_mm": -1e9},
        {"step_mm": 1e-9},
        {"step_mm": math.nan},
        {"passes": 0},
    ):
        with pytest.raises(ValueError, match=re.escape(next(iter(values)))):
            PathParams.model_validate(values)


def small() -> PathPlan:
    return plan_path(bench(), y_from_mm=-20.0, y_to_mm=20.0, step_mm=20.0, passes=2)


async def test_every_point_of_every_pass_is_recorded() -> None:
    context, plan = IdealContext(), small()
    await ValidationPath().run(context, plan)
    await ValidationPath().teardown(context)
    rows = [row for table, row in context.rows if table == "path"]
    assert [row["pass_number"] for row in rows] == [0] * 6 + [1] * 6
    assert [row["y_mm"] for row in rows[:6]] == [-20.0, 0.0, 20.0, 20.0, 0.0, -20.0]
    for row in rows:
        assert row["x_meas_mm"] == pytest.approx(1200.0)
        assert row["y_meas_mm"] == pytest.approx(row["y_mm"] - 500.0)  # type: ignore[operator]  # a number
        assert row["u_mm"] == 0.004
    assert context.progressed[-1][:2] == pytest.approx((plan.duration_s, plan.duration_s))
    assert [text for _, _, text in context.progressed][-1] == "path point 12/12"
    assert context.moves.count(plan.run_in) == 2
    assert set(context.waits) == {(0.5, 0.0, 0)}


async def test_points_that_are_stored_are_not_measured_again() -> None:
    first = IdealContext()
    await ValidationPath().run(first, small())
    again = IdealContext(stored=dict(list(first.stored.items())[:5]))
    await ValidationPath().run(again, small())
    assert again.ran == list(first.stored)[5:]


def test_moves_last_as_long_as_their_slowest_joint() -> None:
    axes = scara_axes(speeds=(100.0, 200.0, 400.0), accelerations=(200.0,) * 3)
    arm = replace(bench().arm, axes=axes, override_percent=50.0)
    travel = np.array([[100.0, 0.0, 9.0, 0.0], [0.0, -2.0, 0.0, 0.0], [0.0] * 4, [12.5, 0.0, 0.0, -400.0]])
    # 50 deg/s: 0.25 s up, 0.25 s down, 87.5 deg between; below full speed 2·sqrt(2/200); 200 deg/s: 1 s up and down.
    assert move_time_s(arm, travel) == pytest.approx([2.25, 0.2, 0.0, 3.0])


Answers = dict[str, str | Callable[[Prompt], str]]


def without_tracker() -> ScaraBench:
    return replace(bench(), tracker=False)


def test_the_cells_instrument_measures_unless_another_is_chosen() -> None:
    assert plan_path(bench()).instrument == "tracker"
    assert plan_path(without_tracker()).instrument == "interferometer"
    assert plan_path(without_tracker(), instrument="file").instrument == "file"
    with pytest.raises(
        PlanError, match=r"no \[tracker\]: add one.*instrument=interferometer.*instrument=file"
    ):
        plan_path(without_tracker(), instrument="tracker")


async def test_an_interrupted_run_reenters_the_path_from_the_proper_side() -> None:
    first = IdealContext()
    await ValidationPath().run(first, small())
    again = IdealContext(
        stored=dict(list(first.stored.items())[:5]), resumed=True, pose=(30.0, 90.0, 12.5, 0.0)
    )
    await ValidationPath().run(again, small())
    point = small().points[4]
    before, there = again.moves[:2]
    assert there[:2] == pytest.approx((point.theta1_deg, point.theta2_deg))
    assert (there[0] - before[0]) * point.direction1 == pytest.approx(1.0)
    assert (there[1] - before[1]) * point.direction2 == pytest.approx(1.0)


@dataclass
class PushedContext(IdealContext):
    """Somebody moves the arm at chosen moments.

    Attributes:
        pushes: J1 by so much, deg, by the number of the measurement during which it happens.
        after: the same, after that measurement: while the run is held before the next point.
        located: J1 and J2 at each measurement, deg.
    """

    pushes: dict[int, float] = field(default_factory=dict)
    after: dict[int, float] = field(default_factory=dict)
    located: list[tuple[float, float]] = field(default_factory=list)

    async def locate(self, settle_time_s: float, commanded_mm: tuple[float, float]) -> Position:
        """Return where the arm stands by then."""
        number = len(self.located)
        self._push(self.pushes.get(number, 0.0))
        self.located.append((self.pose[0], self.pose[1]))
        return await super().locate(settle_time_s, commanded_mm)

    def record(self, record: Record) -> None:
        """Keep a record; then the run is held."""
        super().record(record)
        self._push(self.after.get(len(self.rows) - 1, 0.0))

    def _push(self, by_deg: float) -> None:
        self.pose = (self.pose[0] + by_deg, *self.pose[1:])


def approach_of(context: IdealContext, last: int) -> tuple[float, float]:
    """Return what J1 and J2 move by in a move."""
    before, there = context.moves[last - 1], context.moves[last]
    return there[0] - before[0], there[1] - before[1]


async def test_an_arm_moved_while_held_reapproaches_the_next_point() -> None:
    plan, context = small(), PushedContext(after={3: 25.0})
    await ValidationPath().run(context, plan)
    rows = [row for table, row in context.rows if table == "path"]
    assert len(rows) == 12
    point = plan.points[4]
    # Run-in, four points, take-up, fifth point.
    assert context.moves[6][:2] == pytest.approx((point.theta1_deg, point.theta2_deg))
    assert approach_of(context, 6) == pytest.approx((point.direction1, point.direction2))


async def test_a_point_with_the_arm_moved_is_measured_again() -> None:
    plan, context = small(), PushedContext(pushes={2: 0.5})
    await ValidationPath().run(context, plan)
    rows = [row for table, row in context.rows if table == "path"]
    assert len(rows) == 12
    assert len(context.located) == 13
    for row in rows:
        assert (row["x_meas_mm"], row["y_meas_mm"]) == pytest.approx(
            (float(str(row["x_mm"])) + 1000.0, float(str(row["y_mm"])) - 500.0)
        )
    assert ["somebody has moved it" in text for text in context.warnings] == [True]


async def test_an_arm_moved_repeatedly_ends_the_run() -> None:
    context = PushedContext(pushes={2: 0.5, 3: 0.5, 4: 0.5})
    with pytest.raises(ArmMovedError, match=r"moved 3 times while x 200 mm, y 20 mm.*catseye resume"):
        await ValidationPath().run(context, small())
    assert len(context.rows) == 2


def held(plan: PathPlan, first: int = 0) -> Columns:
    """Return what an instrument in a frame of its own sees, without the first points."""
    points = (plan.points * plan.passes)[first:]
    rows = np.array([(p.x_mm, p.y_mm, p.x_mm + 70.0, p.y_mm - 3.0) for p in points])
    names = ("x_mm", "y_mm", "x_meas_mm", "y_meas_mm")
    return Columns(dict(zip(names, rows.T, strict=True)), np.arange(2, len(points) + 2))


def for_a_file(*, confirm_each: bool = False) -> PathPlan:
    return plan_path(
        bench(),
        y_from_mm=-20.0,
        y_to_mm=20.0,
        step_mm=20.0,
        passes=2,
        instrument="file",
        hold_time_s=3.0,
        confirm_each=confirm_each,
    )


async def test_the_arm_pauses_at_points_measured_from_a_file() -> None:
    plan = for_a_file()
    context = IdealContext(answers={"measured-file": "t.csv"}, files={"t.csv": held(plan)})
    await ValidationPath().run(context, plan)
    assert [duration for _, duration in context.pauses] == [3.0] * 12
    for (pose, _), point in zip(context.pauses, plan.points * 2, strict=True):
        assert arm_xy(pose[0], pose[1]) == pytest.approx((point.x_mm, point.y_mm))
    rows = [row for table, row in context.rows if table == "path"]
    assert [(row["y_meas_mm"], row["pass_number"]) for row in rows] == [
        (point.y_mm - 3.0, number) for number in range(2) for point in plan.points
    ]
    assert context.stored["measured-file"] == {"file": "t.csv", "points": 12}


async def test_a_file_that_cannot_be_used_is_asked_for_again() -> None:
    plan = for_a_file()
    complaint = "a:3: x_meas_mm = 'nan' is not a finite number"
    files: dict[str, Columns | str] = {"a": complaint, "b": held(plan, 1), "c": held(plan)}
    answers: Answers = {"measured-file": "a", "measured-file/2": "b", "measured-file/3": "c"}
    context = IdealContext(answers=answers, files=files)
    await ValidationPath().run(context, plan)
    assert context.warnings[0] == complaint
    assert context.warnings[1].startswith("b: holds 11 points and the path has 12")
    assert context.warnings[1] in context.prompts[2].text
    assert sum(table == "path" for table, _ in context.rows) == 12
    answers = {"measured-file": "a"}
    answers |= {f"measured-file/{number}": "a" for number in range(2, 11)}
    hopeless = IdealContext(answers=answers, files=files)
    with pytest.raises(TableFileError, match=r"10 files could not be used.*catseye resume"):
        await ValidationPath().run(hopeless, plan)


MAPPING = {
    "format": "catseye-mapping/1",
    "separator": "blank",
    "decimal": ".",
    "header_lines": 0,
    "u_mm": 0.015,
    "columns": {
        "x_meas_mm": {"column": 2, "unit": "m"},
        "y_meas_mm": {"column": 3, "unit": "m"},
        "z_meas_mm": {"column": 4, "unit": "m"},
    },
}
"""Of a tracker's text with names, x, y and z."""

MAPPED: dict[str, Any] = {
    "y_from_mm": -20.0,
    "y_to_mm": 20.0,
    "step_mm": 20.0,
    "instrument": "file",
    "mapping": MAPPING,
}


async def test_positions_of_a_mapped_file_need_no_commands() -> None:
    plan = ValidationPath().plan(bench(), PathParams.model_validate(MAPPED))
    tilt = math.radians(10.0)
    places = np.array([(p.x_mm, p.y_mm, 80.0) for p in plan.points])
    seen = places @ [
        [math.cos(tilt), 0.0, -math.sin(tilt)],
        [0.0, 1.0, 0.0],
        [math.sin(tilt), 0.0, math.cos(tilt)],
    ]
    names = ("x_meas_mm", "y_meas_mm", "z_meas_mm")
    rows = Columns(dict(zip(names, seen.T, strict=True)), np.arange(1, 1 + len(seen)))
    context = IdealContext(answers={"measured-file": "t.txt"}, files={"t.txt": rows})
    await ValidationPath().run(context, plan)
    stored = [row for table, row in context.rows if table == "path"]
    assert [row["y_meas_mm"] for row in stored] == pytest.approx([p.y_mm for p in plan.points])
    assert {row["u_mm"] for row in stored} == {0.015}


def test_a_mapping_is_refused_before_anything_moves() -> None:
    with pytest.raises(PlanError, match="mapping is for --param instrument=file, and the interferometer"):
        ValidationPath().plan(bench(), PathParams.model_validate(MAPPED | {"instrument": "interferometer"}))
    wrong = MAPPING | {"columns": {"t_s": {"column": 1, "unit": "s"}}}
    with pytest.raises(ValueError, match=r"columns\.x_meas_mm: Field required.*columns\.t_s: Extra inputs"):
        PathParams.model_validate(MAPPED | {"mapping": wrong})


async def test_each_point_waits_for_the_operators_word() -> None:
    plan = for_a_file(confirm_each=True)
    words: Answers = {f"point/{p}/{n:04d}": "yes" for p in range(2) for n in range(6)}
    words |= {"point/0/0002": "no", "point/0/0002/2": "yes", "measured-file": "t.csv"}
    context = IdealContext(answers=words, files={"t.csv": held(plan)})
    await ValidationPath().run(context, plan)
    third = [pose for pose, _ in context.pauses][2:4]
    assert third[0] == third[1]
    assert len(context.pauses) == 13
    assert all(prompt.motion for prompt in context.prompts if prompt.id.startswith("point/"))
