"""Whitening against dense linear algebra on the whole covariance."""

import numpy as np
import pytest
from scipy import linalg

from catseye.calibration.core.budget import Shared
from catseye.calibration.core.types import Floats
from catseye.calibration.core.whitening import Whitening, through_sources

RNG = np.random.default_rng(5)
ROWS = 30
WEIGHTS = RNG.uniform(10.0, 100.0, ROWS)
EFFECTS = RNG.normal(0.0, 0.05, (ROWS, 4)) @ np.diag([1.0, 30.0, 1e-3, 0.0])
COVARIANCE = np.diag(WEIGHTS**-2) + EFFECTS @ EFFECTS.T


def whitening() -> Whitening:
    return Whitening.of(WEIGHTS, (Shared("one", EFFECTS[:, :1]), Shared("others", EFFECTS[:, 1:])))


def weighted_inverse() -> Floats:
    """Return V⁻¹ in units of the white uncertainties."""
    return np.asarray(linalg.inv(COVARIANCE * np.outer(WEIGHTS, WEIGHTS)), dtype=np.float64)


def test_whitened_rows_have_unit_covariance() -> None:
    root = whitening().rows(np.eye(ROWS))
    assert root @ COVARIANCE @ root.T == pytest.approx(np.eye(ROWS), abs=1e-10)


def test_the_root_is_the_symmetric_one() -> None:
    root = linalg.sqrtm(weighted_inverse())
    assert whitening().again(np.eye(ROWS)) == pytest.approx(root, abs=1e-10)


def test_the_reach_of_the_sources_leaves_the_inverse() -> None:
    reach = whitening().reach
    assert np.eye(ROWS) - reach @ reach.T == pytest.approx(weighted_inverse(), abs=1e-10)


def test_forces_are_those_of_the_inverse_covariance() -> None:
    columns = RNG.normal(size=(ROWS, 3))
    assert whitening().forces(columns) == pytest.approx(linalg.inv(COVARIANCE) @ columns, rel=1e-8)


def test_squares_and_products_are_those_of_the_inverse_covariance() -> None:
    columns = RNG.normal(size=(ROWS, 3))
    products = columns.T @ linalg.inv(COVARIANCE) @ columns
    assert whitening().products(columns) == pytest.approx(products, rel=1e-9)
    assert whitening().square(columns[:, 0]) == pytest.approx(products[0, 0], rel=1e-9)


def test_nothing_cancels_in_a_square_beside_huge_sources() -> None:
    huge = Whitening.of(WEIGHTS, (Shared("scale", 1e6 * EFFECTS[:, :1]),))
    # What lies along the source costs its own size only: one standard deviation of it is 1, however large.
    assert huge.square(1e6 * EFFECTS[:, 0]) == pytest.approx(1.0, rel=1e-9)


def test_without_sources_rows_are_weighted() -> None:
    column = RNG.normal(size=ROWS)
    assert Whitening.of(WEIGHTS).rows(column) == pytest.approx(column * WEIGHTS)


def test_sums_give_the_information_of_the_rows() -> None:
    columns = RNG.normal(size=(ROWS, 3))
    weighted, effects = columns * WEIGHTS[:, None], EFFECTS * WEIGHTS[:, None]
    found = through_sources(weighted.T @ weighted, weighted.T @ effects, effects.T @ effects)
    assert found == pytest.approx(columns.T @ linalg.inv(COVARIANCE) @ columns, rel=1e-9)
