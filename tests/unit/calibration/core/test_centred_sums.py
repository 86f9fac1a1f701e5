"""Rows added one by one, in any order, against the same sums taken at once and against elimination by hand."""

import numpy as np
import pytest

from catseye.calibration.core.centred_sums import CentredSums


def test_one_by_one_gives_the_same_as_all_at_once() -> None:
    rng = np.random.default_rng(1)
    rows = rng.normal(1000.0, 1.0, (60, 5))
    keys = [(int(n), int(k)) for n, k in zip(rng.integers(0, 2, 60), rng.integers(0, 3, 60), strict=True)]
    once, growing = CentredSums.of(rows, keys), CentredSums.empty(4)
    for row, key in zip(rows, keys, strict=True):
        growing.add(row, key)
    assert growing.matrix == pytest.approx(once.matrix, rel=1e-9, abs=1e-9)
    assert growing.counts == once.counts
    for key, mean in once.means.items():
        assert growing.means[key] == pytest.approx(mean)


def test_centred_sums_equal_the_schur_complement() -> None:
    rng = np.random.default_rng(2)
    rows = rng.normal(0.0, 1.0, (20, 3))
    keys = [(0, i // 7) for i in range(20)]
    levels = np.array([[key == (0, k) for k in range(3)] for key in keys], dtype=np.float64)
    # Schur complement of the normal equations of rows and levels together.
    cross = levels.T @ rows
    expected = rows.T @ rows - cross.T @ np.linalg.inv(levels.T @ levels) @ cross
    assert CentredSums.of(rows, keys).matrix == pytest.approx(expected)


def test_a_row_alone_in_its_segment_adds_nothing() -> None:
    sums = CentredSums.empty(2)
    sums.add(np.array([1.0, 2.0, 3.0]), (0, 0))
    assert not sums.matrix.any()
    assert sums.counts == {(0, 0): 1}
