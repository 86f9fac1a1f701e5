"""Forward and inverse kinematics against geometry done by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.calibration.scara.errors import OutOfReachError
from catseye.calibration.scara.planar import forward, inverse, position_jacobian, wrap_rad

L1, L2 = 325.0, 225.0


def test_forward_of_the_square_elbow() -> None:
    position = forward(np.deg2rad([0.0, 90.0]), np.deg2rad([90.0, -90.0]), L1, L2)
    assert position == pytest.approx(np.array([[325.0, 225.0], [225.0, 325.0]]), abs=1e-12)


@given(st.floats(-3.1, 3.1), st.floats(0.01, 3.1), st.sampled_from(["right", "left"]))
def test_inverse_undoes_forward(theta1: float, theta2: float, hand: str) -> None:
    signed = theta2 if hand == "right" else -theta2
    position = forward(np.array([theta1]), np.array([signed]), L1, L2)
    back1, back2 = inverse(position, L1, L2, "right" if hand == "right" else "left")
    assert forward(back1, back2, L1, L2) == pytest.approx(position, abs=1e-7)
    assert back2[0] == pytest.approx(signed, abs=1e-6)


def test_out_of_reach_names_the_position() -> None:
    with pytest.raises(OutOfReachError, match=r"position 2 of 2 \(x = 600 mm"):
        inverse(np.array([[300.0, 0.0], [600.0, 0.0]]), L1, L2)


def test_nan_is_out_of_reach() -> None:
    with pytest.raises(OutOfReachError):
        inverse(np.array([[np.nan, 0.0]]), L1, L2)


def test_jacobian_against_central_differences() -> None:
    rng = np.random.default_rng(1)
    theta1, theta2 = rng.uniform(-2.5, 2.5, 20), rng.uniform(-2.5, 2.5, 20)
    jacobian = position_jacobian(theta1, theta2, L1, L2)
    step = 1e-6
    numeric = np.stack(
        [
            (forward(theta1, theta2, L1 + step, L2) - forward(theta1, theta2, L1 - step, L2)),
            (forward(theta1, theta2, L1, L2 + step) - forward(theta1, theta2, L1, L2 - step)),
            (forward(theta1 + step, theta2, L1, L2) - forward(theta1 - step, theta2, L1, L2)),
            (forward(theta1, theta2 + step, L1, L2) - forward(theta1, theta2 - step, L1, L2)),
        ],
        axis=-1,
    ) / (2 * step)
    assert jacobian == pytest.approx(numeric, abs=1e-6)


def test_wrap_keeps_plus_pi() -> None:
    assert wrap_rad(np.array([np.pi, -np.pi, 3 * np.pi, 0.5])) == pytest.approx([np.pi, np.pi, np.pi, 0.5])
