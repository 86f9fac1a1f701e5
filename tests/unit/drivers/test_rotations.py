"""Rotations in one order and in the other, against scipy's."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from catseye.drivers.roles.rotations import as_fixed_axes_deg

angles = st.floats(-180.0, 180.0)


@given(angles, angles, angles)
def test_moving_axes_are_turned_into_fixed_ones(rx: float, ry: float, rz: float) -> None:
    # scipy: capital letters turn about moving axes, R = Rx·Ry·Rz; small ones about fixed ones, R = Rz·Ry·Rx.
    expected = Rotation.from_euler("XYZ", (rx, ry, rz), degrees=True).as_matrix()
    found = Rotation.from_euler("xyz", as_fixed_axes_deg((rx, ry, rz)), degrees=True).as_matrix()
    np.testing.assert_allclose(found, expected, atol=1e-7)


@pytest.mark.parametrize("turn", [(90.0, 90.0, 0.0), (-90.0, 0.0, 90.0), (0.0, 0.0, 0.0)])
def test_a_standing_axis_is_no_exception(turn: tuple[float, float, float]) -> None:
    expected = Rotation.from_euler("XYZ", turn, degrees=True).as_matrix()
    found = Rotation.from_euler("xyz", as_fixed_axes_deg(turn), degrees=True).as_matrix()
    np.testing.assert_allclose(found, expected, atol=1e-12)
