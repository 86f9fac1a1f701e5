"""Shipped arms against products of exponentials, and against poses that others have published."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from catseye.calibration.kinematics.chain import Chain, Joint
from catseye.calibration.kinematics.rotations import angles_of, pose_of
from tests.unit.calibration.kinematics.chains import NAMES, chain, miss, poses
from tests.unit.calibration.kinematics.screws import ARMS, KR360

KR360_CHAIN = Chain(
    tuple(
        Joint(
            joint.name,
            joint.kind,
            joint.alpha_deg,
            a_mm,
            joint.theta_offset_deg,
            d_mm,
            joint.sign,
            -350.0,
            350.0,
        )
        for joint, (a_mm, d_mm) in zip(
            chain("kr210-r2700").joints,
            [(0.0, 1045.0), (500.0, 0.0), (1300.0, 0.0), (-55.0, 1025.0), (0.0, 0.0), (0.0, 290.0)],
            strict=True,
        )
    )
)
"""The KR 360 R2830 has the shape of the KR 210 and other lengths."""

CONTROLLER_POSES = (
    ([0.0, -90.0, 45.0, 0.0, 0.0, 0.0], [1468.736, 0.0, 3235.954], [0.0, 45.0, 0.0]),
    ([45.0, -90.0, 45.0, 0.0, 0.0, 0.0], [1038.553, -1038.553, 3235.954], [-45.0, 45.0, 0.0]),
    ([45.0, -90.0, 90.0, 0.0, 30.0, 0.0], [1255.926, -1255.926, 2145.0], [-45.0, 120.0, 0.0]),
    ([45.0, -90.0, 90.0, 30.0, 30.0, 30.0], [1204.661, -1307.191, 2164.426], [16.813, 156.453, 61.813]),
    ([45.0, -45.0, 120.0, 60.0, -60.0, 45.0], [1419.677, -1112.085, 852.371], [-93.717, 28.605, -114.990]),
    ([0.0, -129.0, 143.0, -8.0, 118.0, 30.0], [469.6913, 35.6362, 1540.8577], [39.8346, -149.4608, -31.4434]),
    ([0.0, 20.0, -90.0, 5.0, 50.0, 30.0], [2395.5593, -19.3607, 1644.2620], [-65.1385, 52.9548, -55.2899]),
)  # fmt: skip
"""A1...A6, X, Y, Z and A, B, C of a KR 360 R2830, published with status and turn as controllers state them in the
public tests of an inverse solver (class CustomKukaIKSolver)."""


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=30)
@given(data=st.data())
def test_frames_agree_with_products_of_exponentials(name: str, data: st.DataObject) -> None:
    pose = data.draw(poses(name))
    apart_mm, apart = miss(chain(name).frames(pose)[-1, 0], ARMS[name].forward(pose[0]))
    # Rounding at 2.7 m and angles up to a turn.
    assert apart_mm < 1e-9
    assert apart < 1e-12


@pytest.mark.parametrize(("pose", "place_mm", "abc_deg"), CONTROLLER_POSES)
def test_a_controllers_poses_come_out(pose: list[float], place_mm: list[float], abc_deg: list[float]) -> None:
    published = pose_of(np.array(place_mm), np.array(abc_deg[::-1]))
    # Published joints are rounded to 0.001 deg, the arm is 3 m long.
    for found in (KR360_CHAIN.frames(np.array([pose]))[-1, 0], KR360.forward(np.array(pose))):
        apart_mm, apart = miss(found, published)
        assert apart_mm < 0.05
        assert apart < 5e-5


def test_the_kr210_points_forward_in_its_zero_position() -> None:
    # The mesh of its last link is drawn there: x = 1.765 m, z = 1.784 m (kuka_robot_descriptions,
    # kr210_r2700_extra_macro.xacro).
    flange = chain("kr210-r2700").frames(np.array([[0.0, -90.0, 90.0, 0.0, 0.0, 0.0]]))[-1, 0]
    assert flange[:3, 3] == pytest.approx([1765.0, 0.0, 1784.0])
    assert angles_of(flange[:3, :3]) == pytest.approx([0.0, 90.0, 0.0], abs=1e-9)


def test_positive_axes_of_a_kuka_turn_its_way() -> None:
    place = chain("kr210-r2700").frames(
        np.array([[90.0, -90.0, 90.0, 0.0, 0.0, 0.0], [0.0, -80.0, 90.0, 0.0, 0.0, 0.0]])
    )[-1, :, :3, 3]
    assert place[0] == pytest.approx([0.0, -1765.0, 1784.0])  # A1 clockwise from above
    assert place[1, 0] > 1765.0  # A2 leans forward


def test_the_irb120_at_zero_is_as_its_lengths_add_up() -> None:
    # 302 + 72 and 290 + 270 + 70 mm; tool0 is turned by 90 deg about y (abb_irb120_support): z forward, x down.
    flange = chain("irb120").frames(np.zeros((1, 6)))[-1, 0]
    assert flange[:3, 3] == pytest.approx([374.0, 0.0, 630.0])
    assert flange[:3, :3] == pytest.approx(
        np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]), abs=1e-12
    )
