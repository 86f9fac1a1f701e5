"""Tables of several instruments: in one frame they are one, in frames of their own they are not."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.plausibility import ImplausibleError, require_plausible
from catseye.calibration.serial_arm.several_tables import Tables, mistake_between
from tests.unit.calibration.serial_arm.nominal import irb120, measured
from tests.unit.calibration.serial_arm.true_arm import random_poses

TABLES = Tables(np.arange(60) // 30, np.zeros(0, dtype=np.int64))


def moved(count: int) -> Measurements:
    """Move and turn the last places as another instrument would see them."""
    rows = measured(random_poses(60, 1), 1)
    x, y, z = rows.points.place_mm.T
    other = np.column_stack([300.0 - y, 2000.0 + x, z - 100.0])
    seen = np.where(np.arange(60)[:, None] < 60 - count, rows.points.place_mm, other)
    return replace(rows, points=replace(rows.points, place_mm=seen))


def test_tables_in_frames_of_their_own_are_named() -> None:
    with pytest.raises(
        ImplausibleError, match=r"in different frames \(those of pose 'pose 1', pose 'pose 31'\)"
    ):
        require_plausible(irb120(), moved(30), tables=TABLES)


def test_tables_in_one_frame_pass() -> None:
    assert mistake_between(irb120(), moved(0), TABLES) is None
    assert mistake_between(irb120(), moved(30), TABLES) is not None
    require_plausible(irb120(), moved(0), tables=TABLES)


def test_a_mistake_of_both_tables_is_named_as_such() -> None:
    rows = moved(0)
    in_m = replace(rows, points=replace(rows.points, place_mm=rows.points.place_mm / 1000.0))
    with pytest.raises(ImplausibleError, match="if the coordinates are in m"):
        require_plausible(irb120(), in_m, tables=TABLES)
