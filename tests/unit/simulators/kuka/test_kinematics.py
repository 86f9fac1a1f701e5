"""What the controller believes of its arm, against what its description states and against plain geometry."""

import numpy as np
import pytest

from catseye.simulators.config import Joints
from catseye.simulators.kuka.kinematics import Kinematics, UnsolvableError
from catseye.simulators.world.types import Floats
from tests.unit.simulators.kuka.benches import UPRIGHT
from tests.unit.simulators.world.serial.arms import serial_arm

KUKA = Kinematics(serial_arm("kr210-r2700"))
CANDLE = (0.0, -90.0, 90.0, 0.0, 0.0, 0.0)


def test_the_flange_is_where_the_description_states_it() -> None:
    place = KUKA.place(CANDLE)
    # kr210-r2700.toml: X 1765, Y 0, Z 1784, A 0, B 90, C 0.
    assert [place.number(axis) for axis in "XYZ"] == pytest.approx([1765.0, 0.0, 1784.0], abs=1e-3)
    assert place.number("B") == pytest.approx(90.0, abs=1e-4)


def test_a1_turns_the_flange_about_the_column_clockwise() -> None:
    place = KUKA.place((30.0, *UPRIGHT[1:]))
    straight = KUKA.place(UPRIGHT)
    assert np.arctan2(place.number("Y"), place.number("X")) == pytest.approx(np.deg2rad(-30.0), abs=1e-6)
    assert place.number("Z") == pytest.approx(straight.number("Z"), abs=1e-3)
    assert (place.number("A") - straight.number("A")) % 360.0 == pytest.approx(330.0, abs=1e-4)


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.6, 0.0, -0.8)])
def test_a_line_is_straight_and_keeps_the_orientation(direction: tuple[float, float, float]) -> None:
    start = KUKA.flange(UPRIGHT)
    goal = start.copy()
    goal[:3, 3] += 2.0 * np.array(direction)
    way = KUKA.line(UPRIGHT, goal, 8)
    for number, joints in enumerate(way, 1):
        flange = KUKA.flange(tuple(joints))
        assert flange[:3, :3] == pytest.approx(start[:3, :3], abs=1e-9)
        assert flange[:3, 3] == pytest.approx(start[:3, 3] + 0.25 * number * np.array(direction), abs=1e-6)


def turned_about_z(angle_deg: float) -> Floats:
    sine, cosine = np.sin(np.deg2rad(angle_deg)), np.cos(np.deg2rad(angle_deg))
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def test_a_line_turns_the_flange_evenly() -> None:
    start = KUKA.flange(UPRIGHT)
    goal = start.copy()
    goal[:3, :3] = turned_about_z(0.04) @ start[:3, :3]
    for number, joints in enumerate(KUKA.line(UPRIGHT, goal, 4), 1):
        flange = KUKA.flange(tuple(joints))
        assert flange[:3, :3] == pytest.approx(turned_about_z(0.01 * number) @ start[:3, :3], abs=1e-9)
        assert flange[:3, 3] == pytest.approx(start[:3, 3], abs=1e-6)


@pytest.mark.parametrize(
    "measured", [(12.3, -80.0, 70.0, 30.0, 50.0, 10.0), (-60.0, -100.0, 90.0, 100.0, -60.0, 80.0)]
)
def test_a_straight_step_begins_at_the_measured_frame(measured: Joints) -> None:
    goal, here = KUKA.stepped(measured, np.array([0.1, -0.2, 0.3])), KUKA.flange(measured)
    # REALs of 32 bits: 1.2e-4 mm apart above 1024 mm, 1.5e-5° above 128°.
    assert goal[:3, 3] - here[:3, 3] == pytest.approx([0.1, -0.2, 0.3], abs=1.3e-4)
    assert goal[:3, :3] == pytest.approx(here[:3, :3], abs=5e-7)
    assert np.linalg.det(goal[:3, :3]) == pytest.approx(1.0, abs=1e-12)


def test_a_line_through_a_singularity_has_no_joints() -> None:
    goal = KUKA.flange(CANDLE)
    goal[1, 3] += 1.0
    with pytest.raises(UnsolvableError):
        KUKA.line(CANDLE, goal, 4)


def test_a_goal_out_of_reach_has_no_joints() -> None:
    goal = KUKA.flange(UPRIGHT)
    goal[0, 3] += 5000.0
    with pytest.raises(UnsolvableError):
        KUKA.line(UPRIGHT, goal, 4)
