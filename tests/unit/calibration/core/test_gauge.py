"""A gauge's steps, and matrices on them, against linear algebra written out."""

import numpy as np
import pytest

from catseye.calibration.core.budget import harmonics
from catseye.calibration.core.gauge import Gauge

GAUGES = {"mean of some": Gauge.mean_of(slice(2, 6), 9), "mean of one": Gauge.mean_of(slice(0, 1), 4)}


@pytest.mark.parametrize("name", GAUGES)
def test_its_steps_are_all_that_keep_the_mean(name: str) -> None:
    gauge = GAUGES[name]
    size = gauge.normal.size
    part = slice(2, 6) if name == "mean of some" else slice(0, 1)
    assert gauge.basis.shape == (size, gauge.free) == (size, size - 1)
    assert gauge.basis.T @ gauge.basis == pytest.approx(np.eye(size - 1), abs=1e-15)
    assert gauge.basis[part].mean(axis=0) == pytest.approx(np.zeros(size - 1), abs=1e-15)


@pytest.mark.parametrize("name", GAUGES)
def test_matrices_are_those_of_its_basis(name: str) -> None:
    gauge, rng = GAUGES[name], np.random.default_rng(1)
    whole, part = (rng.normal(size=(n, n)) for n in (gauge.normal.size, gauge.free))
    whole, part = whole + whole.T, part + part.T
    assert gauge.reduced(whole) == pytest.approx(gauge.basis.T @ whole @ gauge.basis, abs=1e-13)
    assert gauge.expanded(part) == pytest.approx(gauge.basis @ part @ gauge.basis.T, abs=1e-13)


def test_without_a_constraint_nothing_changes() -> None:
    gauge, matrix = Gauge.none(3), np.diag([1.0, 2.0, 3.0])
    assert gauge.free == 3
    assert np.array_equal(gauge.basis, np.eye(3))
    assert np.array_equal(gauge.expanded(gauge.reduced(matrix)), matrix)


def test_harmonics_are_cosine_and_sine_of_each_order() -> None:
    angle = np.random.default_rng(2).uniform(-7.0, 7.0, 50)
    found = harmonics(angle, 40)
    for order in range(1, 41):
        expected = np.column_stack([np.cos(order * angle), np.sin(order * angle)])
        # Each product rounds once: 40 times the machine's precision, and that of 40 angle itself.
        assert np.abs(found[:, 2 * order - 2 : 2 * order] - expected).max() < 1e-13
