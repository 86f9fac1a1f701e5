"""Points of a slice: where they are, how the arm stands there, and where it does not."""

import numpy as np
import pytest

from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.kinematics.rotations import pose_of
from catseye.calibration.resolution.workspace_slice import SliceAxis, slice_points
from tests.unit.calibration.kinematics.chains import chain
from tests.unit.calibration.kinematics.screws import ARMS

POSE = np.array([20.0, -80.0, 95.0, 15.0, 30.0, -40.0])
TOOL = pose_of(np.array([40.0, 0.0, 180.0]), np.array([0.0, 15.0, 0.0]))


def test_points_keep_orientation_and_what_is_left_out() -> None:
    start = ARMS["kr210-r2700"].forward(POSE) @ TOOL
    axes = {"z": SliceAxis(900.0, 1500.0, 3), "x": SliceAxis(1400.0, 1600.0, 2)}
    found = slice_points(chain("kr210-r2700"), POSE, axes, TOOL)  # type: ignore[arg-type]  # names are literals
    places = [(x, start[1, 3], z) for x in (1400.0, 1600.0) for z in (900.0, 1200.0, 1500.0)]
    assert len(found) == 6
    for point, place in zip(found, places, strict=True):
        assert point.joints is not None
        reached = ARMS["kr210-r2700"].forward(point.joints) @ TOOL
        assert point.tcp_mm == pytest.approx(place)
        assert reached[:3, 3] == pytest.approx(place, abs=1e-6)
        assert np.abs(reached[:3, :3] - start[:3, :3]).max() < 1e-9


def test_a_point_beyond_the_reach_has_the_reason() -> None:
    near, far = slice_points(chain("kr210-r2700"), POSE, {"x": SliceAxis(1500.0, 9000.0, 2)})
    assert near.joints is not None
    assert far.joints is None
    assert "the arm reaches" in far.reason


def test_more_points_than_can_be_predicted_are_refused() -> None:
    axes = {"x": SliceAxis(0.0, 1.0, 1000), "z": SliceAxis(0.0, 1.0, 101)}
    with pytest.raises(ArgumentError, match="the slice has 101000 points, 100000 at most"):
        slice_points(chain("kr210-r2700"), POSE, axes)  # type: ignore[arg-type]  # names are literals


@pytest.mark.parametrize("wrong", [(2.0, 1.0, 3), (1.0, 2.0, 1), (float("nan"), 2.0, 3)])
def test_an_axis_without_a_meaning_is_refused(wrong: tuple[float, float, int]) -> None:
    with pytest.raises(ArgumentError):
        SliceAxis(*wrong)
