"""Distances with the interferometer turned on its flange: columns of points."""

from dataclasses import replace

import numpy as np

from catseye.calibration.scara.points import concatenated
from tests.unit.calibration.scara.samples import noisy_points


def test_mountings_go_with_the_rows() -> None:
    plain = noisy_points()
    mounts = np.deg2rad([0.0, 180.5, 90.0])[plain.dead_path]
    turned = replace(plain, mount_rad=mounts)
    chosen = np.flatnonzero(plain.dead_path > 0)
    kept = turned.select(chosen).mount_rad
    assert kept is not None
    assert np.array_equal(kept, mounts[chosen])
    assert plain.select(chosen).mount_rad is None


def test_without_a_mounting_it_is_zero_beside_others() -> None:
    plain = noisy_points()
    first, second = plain.rows(plain.dead_path == 0), plain.rows(plain.dead_path == 1)
    turned = replace(second, mount_rad=np.full(len(second), np.pi))
    assert concatenated([first, second]).mount_rad is None
    joined = concatenated([first, turned]).mount_rad
    assert joined is not None
    assert joined.tolist() == [0.0] * len(first) + [np.pi] * len(second)
