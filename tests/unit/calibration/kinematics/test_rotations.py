"""Rotations against SciPy's and against an exponential, poses against their inverses."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.rotations import (
    angles_of,
    inverted,
    pose_of,
    require_poses,
    rotation_of,
    rotation_vectors_deg,
)
from catseye.calibration.kinematics.types import Floats

ANGLES = st.tuples(*(st.floats(-360.0, 360.0) for _ in range(3)))


@given(ANGLES)
def test_rotations_turn_about_fixed_x_then_y_then_z(angles: tuple[float, float, float]) -> None:
    expected = Rotation.from_euler("xyz", angles, degrees=True).as_matrix()
    assert rotation_of(np.array(angles)) == pytest.approx(expected, abs=1e-14)


@given(ANGLES)
def test_angles_give_their_rotation_again(angles: tuple[float, float, float]) -> None:
    rotation = rotation_of(np.array(angles))
    found = angles_of(rotation)
    # Beside the lock a cosine of 1e-9 loses seven digits.
    assert rotation_of(found) == pytest.approx(rotation, abs=2e-9)
    assert abs(found[1]) <= 90.0


@pytest.mark.parametrize("ry", [90.0, -90.0])
def test_the_third_angle_is_zero_where_two_axes_coincide(ry: float) -> None:
    rotation = rotation_of(np.array([20.0, ry, 50.0]))
    assert angles_of(rotation)[1:] == pytest.approx([ry, 0.0])
    assert rotation_of(angles_of(rotation)) == pytest.approx(rotation, abs=1e-14)


def crossed(vector: Floats) -> Floats:
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


@given(ANGLES, st.floats(0.0, 180.0) | st.floats(0.0, 1e-6) | st.floats(179.999999, 180.0))
def test_rotation_vectors_are_logarithms_up_to_half_a_turn(
    seed: tuple[float, float, float], angle_deg: float
) -> None:
    axis = rotation_of(np.array(seed))[:, 0]
    (found,) = rotation_vectors_deg(expm(crossed(axis * math.radians(angle_deg)))[None])
    if angle_deg < 179.999:
        assert found == pytest.approx(axis * angle_deg, abs=1e-11, rel=1e-9)
    assert expm(crossed(np.deg2rad(found))) == pytest.approx(
        expm(crossed(axis * math.radians(angle_deg))), abs=1e-13
    )


@given(ANGLES)
def test_a_pose_times_its_inverse_is_nothing(angles: tuple[float, float, float]) -> None:
    pose = pose_of(np.array([100.0, -2000.0, 30.0]), np.array(angles))
    assert pose @ inverted(pose) == pytest.approx(np.eye(4), abs=1e-11)


@pytest.mark.parametrize(
    ("change", "part"),
    [
        (lambda pose: pose[:, :3], "shape"),
        (lambda pose: pose[0], "shape"),
        (lambda pose: pose * np.nan, "row 0 is not a rigid transform"),
        (lambda pose: pose * [[[1.0], [1.0], [-1.0], [1.0]]], "row 0"),
        (lambda pose: np.concatenate([pose, 1.01 * pose]), "row 1"),
    ],
)
def test_what_is_no_pose_is_refused(change: object, part: str) -> None:
    assert callable(change)
    pose = pose_of(np.array([[1.0, 2.0, 3.0]]), np.array([[4.0, 5.0, 6.0]]))
    require_poses(pose, "targets")
    with pytest.raises(KinematicsError, match=rf"targets: .*{part}"):
        require_poses(change(pose), "targets")
