"""Ways, times, speeds and steps by hand of an arm with six axes, against figures by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.drivers.roles.pose import out_of_range, pose_of, pose_text
from catseye.procedures.kit.errors import ManualStepError, PlanError, WayBlockedError
from catseye.procedures.kit.motion.body_speed import fastest_mm_s, top_speed_mm_s
from catseye.procedures.kit.motion.clear_way import clear_part, require_clear_way
from catseye.procedures.kit.motion.motion_time import leg_rates, move_time_s, way_time_s
from catseye.procedures.kit.system import System
from tests.unit.procedures.six_axes import BENCH, HEIGHT_MM, REACH_MM, STRETCHED, TOOL_MM, with_post

SYSTEM = System(BENCH)
ASIDE = (90.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_a_pose_is_told_with_names_and_units() -> None:
    pose = (1.0, -2.5, 3.0, 0.0, 45.125, -400.0)
    assert (
        pose_text(BENCH.arm.axes, pose, digits=1)
        == "A1 1.0°, A2 -2.5°, A3 3.0°, A4 0.0°, A5 45.1°, A6 -400.0°"
    )


def test_every_axis_outside_its_range_is_named() -> None:
    pose = (0.0, 0.0, -90.5, 0.0, float("nan"), 400.0)
    assert out_of_range(BENCH.arm.axes, pose) == [
        "A3 = -90.5 deg is outside -90 … 90 deg",
        "A5 = nan deg is outside -120 … 120 deg",
    ]


def test_a_pose_of_another_arm_is_refused() -> None:
    with pytest.raises(ValueError, match="4 values where the arm has 6 axes"):
        pose_of(BENCH.arm.axes, [0, 0, 0, 0])
    assert pose_of(BENCH.arm.axes, [1, 2, 3, 4, 5, 6]) == (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)


def test_moves_last_as_long_as_the_slowest_of_six() -> None:
    # At 10 %: 25 deg/s after 25²/1000 deg; 42 deg/s of the last axis.
    travel = np.array([[25.0, 0, 0, 0, 0, 84.0], [0, 0, 0, 0, 0, 84.0], [0, 0, -0.1, 0, 0, 0], [0.0] * 6])
    expected = [2.0 + 0.042, 2.0 + 0.042, 2.0 * math.sqrt(0.1 / 1000.0), 0.0]
    assert move_time_s(BENCH.arm, travel) == pytest.approx(expected)


def test_a_streamed_way_keeps_the_speed_of_the_cell() -> None:
    arm = replace(BENCH.arm, following="streamed", follow_speed_deg_s=5.0, follow_acceleration_deg_s2=50.0)
    ends = np.array([STRETCHED, (0.0, 0.0, 0.0, 0.0, 0.0, 20.0)])
    assert way_time_s(arm, ends) == pytest.approx(4.0 + 0.1 * math.pi / 2.0)
    assert leg_rates(arm, np.diff(ends, axis=0)) == pytest.approx([5.0 / 20.0])


def test_the_tool_is_where_the_drawing_has_it() -> None:
    places = SYSTEM.tool_mm(np.array([STRETCHED, ASIDE]))
    assert places == pytest.approx(np.array([[REACH_MM, 0.0, HEIGHT_MM], [0.0, REACH_MM, HEIGHT_MM]]))


def test_the_circle_of_a_body_bounds_its_speed() -> None:
    turned = (0.0, 0.0, 0.0, 0.0, 0.0, 90.0)
    # The far end of the tool, 50 mm beside the axis and 10 mm thick, at a tenth of 420 deg/s.
    edge_mm_s = (TOOL_MM + 10.0) * math.radians(42.0)
    assert fastest_mm_s(BENCH, STRETCHED, turned, 10.0) == pytest.approx(edge_mm_s)
    assert top_speed_mm_s(BENCH, 10.0) > REACH_MM * math.radians(25.0) + edge_mm_s


def test_a_post_in_the_way_of_axis_one_is_met() -> None:
    post = with_post(45.0)
    with pytest.raises(
        PlanError, match=r"the keep-out box post stands in the arm's way.*target 1 of 1, A1 90\.0°"
    ):
        require_clear_way([STRETCHED, ASIDE], post)
    require_clear_way([STRETCHED, ASIDE], BENCH)
    require_clear_way([STRETCHED, (10.0, 0.0, 0.0, 0.0, 0.0, 0.0)], post)


def test_the_clear_part_ends_ahead_of_the_post() -> None:
    end, obstacle = clear_part(STRETCHED, ASIDE, with_post(45.0))
    assert obstacle is not None
    # The post begins 20 mm before 45° as seen from the tool; its corner and the tool's bodies take no more than 15°.
    assert 30.0 - math.degrees(60.0 / REACH_MM) < end[0] < 45.0 - math.degrees(20.0 / REACH_MM)
    assert end[1:] == (0.0,) * 5


def test_the_way_in_is_straight_or_refused() -> None:
    assert SYSTEM.way_in(STRETCHED, ASIDE) == (ASIDE,)
    with pytest.raises(WayBlockedError, match="post"):
        System(with_post(45.0)).way_in(STRETCHED, ASIDE)


def test_each_axis_is_stepped_by_its_name() -> None:
    assert SYSTEM.jog_names == ("a1", "a2", "a3", "a4", "a5", "a6")
    assert SYSTEM.step_target(STRETCHED, "a5", -2.0) == (0.0, 0.0, 0.0, 0.0, -2.0, 0.0)
    assert SYSTEM.manual_axes == BENCH.arm.axes


@pytest.mark.parametrize(("name", "aim"), [("j1", None), ("beam", None), ("a1", "P1")])
def test_what_does_not_move_is_refused(name: str, aim: str | None) -> None:
    with pytest.raises(ManualStepError):
        SYSTEM.step_target(STRETCHED, name, 1.0, aim)
