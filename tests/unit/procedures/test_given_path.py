"""Lines of a file: each entered from its own side, with height and orientation of the tool."""

import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.procedures.kit.errors import PlanError, PlanLimitError
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.path.path_plan import PathPlan
from catseye.procedures.scara.path.validation_path import PathParams, ValidationPath
from catseye.procedures.scara.tool_zero import ToolZero
from tests.unit.procedures.benches import IdealContext, arm_xy, bench, with_axes

UP = [{"line": 1, "x_mm": 250.0, "y_mm": y} for y in (-60.0, 0.0, 60.0)]
DOWN = [{"line": 2, "x_mm": 300.0, "y_mm": y} for y in (60.0, 0.0, -60.0)]


def high() -> ScaraBench:
    """Return the bench with all of J3's stroke."""
    return with_axes(bench(), j3_mm=(0.0, 150.0))


def planned(rows: list[dict[str, float]], **further: object) -> PathPlan:
    return ValidationPath().plan(high(), PathParams.model_validate({"path": rows, **further}))


async def test_each_line_is_entered_in_its_own_direction() -> None:
    context, plan = IdealContext(), planned([*UP, *DOWN], passes=2)
    await ValidationPath().run(context, plan)
    places = [arm_xy(move[0], move[1]) for move in context.moves]
    wished = [(row["x_mm"], row["y_mm"]) for row in (*UP, *DOWN)]
    found = [
        number for number, place in enumerate(places) if min(math.dist(place, one) for one in wished) < 1e-6
    ]
    assert np.array([places[number] for number in found]) == pytest.approx(np.array(wished * 2), abs=1e-6)
    for number in (found[0], found[3], found[6], found[9]):
        before, there, after = (np.array(context.moves[place][:2]) for place in range(number - 1, number + 2))
        # The take-up of 1° has the sign of the line's own first motion.
        assert there - before == pytest.approx(np.sign(after - there))
    rows = [row for table, row in context.rows if table == "path"]
    assert [row["line"] for row in rows] == [1, 1, 1, 2, 2, 2] * 2
    assert context.progressed[-1][:2] == pytest.approx((plan.duration_s, plan.duration_s))


async def test_a_resumed_run_enters_the_next_line_from_its_side() -> None:
    plan, first = planned([*UP, *DOWN]), IdealContext()
    await ValidationPath().run(first, plan)
    stored = dict(list(first.stored.items())[:4])
    again = IdealContext(stored=stored, resumed=True, pose=(-30.0, 90.0, 12.5, 0.0))
    await ValidationPath().run(again, plan)
    assert [row["line"] for table, row in again.rows if table == "path"] == [2, 2, 2]
    before, there, after = (np.array(move[:2]) for move in again.moves[:3])
    assert there == pytest.approx([plan.points[3].theta1_deg, plan.points[3].theta2_deg])
    assert there - before == pytest.approx(np.sign(after - there))


async def test_height_and_orientation_are_driven() -> None:
    rows = [
        {**row, "z_mm": z_mm, "c_deg": 30.0}
        for row, z_mm in zip((*UP, *DOWN), (20, 30, 40, 90, 90, 90), strict=True)
    ]
    context, plan = IdealContext(), planned(rows)
    await ValidationPath().run(context, plan)
    measured = [row for table, row in context.rows if table == "path"]
    assert [row["j3_mm"] for row in measured] == [20, 30, 40, 90, 90, 90]
    reached = {tuple(round(joint, 9) for joint in move) for move in context.moves}
    for row in measured:
        joints = [float(str(row[name])) for name in ("theta1_deg", "theta2_deg", "j3_mm", "j4_deg")]
        assert joints[0] + joints[1] + joints[3] == pytest.approx(30.0)
        assert tuple(round(joint, 9) for joint in joints) in reached


def test_the_cells_zero_of_the_tool_counts() -> None:
    turned = replace(high(), tool_zero=ToolZero(z_mm=5.0, c_deg=90.0))
    rows = [{**row, "z_mm": 25.0, "c_deg": 30.0} for row in UP]
    plan = ValidationPath().plan(turned, PathParams.model_validate({"path": rows}))
    for point in plan.points:
        assert point.j3_mm == 20.0
        assert point.theta1_deg + point.theta2_deg + (point.j4_deg or 0.0) + 90.0 == pytest.approx(30.0)


def test_limits_of_height_and_orientation_are_kept() -> None:
    with pytest.raises(
        PlanLimitError, match=r"needs J3 160\.00 mm, outside its limits 0…150: choose another z_mm"
    ):
        planned([{**row, "z_mm": 160.0} for row in UP])
    tight = with_axes(bench(), j4_deg=(-20.0, 20.0))
    rows = [{**row, "c_deg": 180.0} for row in UP]
    with pytest.raises(PlanLimitError, match=r"needs J4 .*outside its limits -20…20: choose another c_deg"):
        ValidationPath().plan(tight, PathParams.model_validate({"path": rows}))


def test_joint_commands_of_a_file_are_driven_as_they_stand() -> None:
    rows = [
        {"theta1_deg": one, "theta2_deg": 50.0, "direction1": state, "direction2": 1}
        for one, state in ((-20.0, 1), (-15.0, 1), (-15.3, -1))
    ]
    plan = planned(rows)
    assert [(p.theta1_deg, p.direction1) for p in plan.points] == [(-20.0, 1), (-15.0, 1), (-15.3, -1)]
    for point in plan.points:
        assert arm_xy(point.theta1_deg, point.theta2_deg) == pytest.approx((point.x_mm, point.y_mm))
    assert plan.run_in[:2] == (-21.0, 49.0)
    assert plan.come_from[1] is None
    assert plan.come_from[2] is not None
    assert plan.come_from[2][:2] == pytest.approx((-14.3, 50.0))


async def test_an_obstacle_between_two_lines_is_gone_around() -> None:
    # Straight in joints, the way from line to line leads through the reflector P2 before the arm.
    rows = [{"line": 1, "x_mm": 330.0, "y_mm": y} for y in (-420.0, -400.0)]
    rows += [{"line": 2, "x_mm": 330.0, "y_mm": y} for y in (400.0, 420.0)]
    here = replace(
        bench(), reflectors=tuple(replace(one, x_mm=530.0, y_mm=0.0) for one in bench().reflectors[:1])
    )
    context = IdealContext(pose=(-90.0, 60.0, 12.5, 0.0))
    plan = ValidationPath().plan(here, PathParams.model_validate({"path": rows}))
    await ValidationPath().run(context, plan)
    assert len([row for table, row in context.rows if table == "path"]) == 4
    left = next(n for n, move in enumerate(context.moves) if move == plan.points[1].pose(here))
    entered = next(n for n, move in enumerate(context.moves) if move == plan.come_from[2])
    assert entered - left > 1


async def test_the_interferometer_measures_several_lines() -> None:
    context, plan = IdealContext(), planned([*UP, *DOWN], instrument="interferometer")
    await ValidationPath().run(context, plan)
    rows = [row for table, row in context.rows if table == "path"]
    assert [row["line"] for row in rows] == [1, 1, 1, 2, 2, 2]
    assert all(row["displacement_mm"] is not None for row in rows)


@pytest.mark.parametrize(
    ("rows", "further", "part"),
    [
        ([*UP, *DOWN, *UP], {}, "row 7 of the path: line 1 was left before"),
        ([{**UP[0], "c_deg": 0.0}, UP[1]], {}, "row 2 of the path has no c_deg"),
        ([{**row, "c_deg": 0.0} for row in UP], {"instrument": "interferometer"}, "turns J4 to aim"),
        (
            [{**row, "z_mm": 40.0} for row in UP],
            {"instrument": "interferometer"},
            "the beam is level at j3_mm",
        ),
        (
            [{"theta1_deg": 0.0, "theta2_deg": 50.0, "direction1": 1, "direction2": 1}],
            {"instrument": "interferometer"},
            "instrument=file",
        ),
        ([{"x_mm": 0.25, "y_mm": 0.1 * n} for n in range(3)], {}, "seem to be in m: .*convert them to mm"),
        (UP, {"joints": [[300.0, 100.0, -20.0, 60.0, 1.0, -1.0]]}, "give one of them"),
    ],
)
def test_a_path_that_cannot_be_driven_is_refused(
    rows: list[dict[str, float]], further: dict[str, object], part: str
) -> None:
    with pytest.raises(PlanError, match=part):
        planned(rows, **further)


def test_a_row_of_neither_form_is_refused() -> None:
    with pytest.raises(ValueError, match=r"either x_mm, y_mm or theta1_deg"):
        PathParams.model_validate({"path": [{"x_mm": 1.0, "theta1_deg": 2.0}]})
