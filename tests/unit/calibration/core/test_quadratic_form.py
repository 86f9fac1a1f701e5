"""Sums of squares of correlated errors against dense algebra, known distributions and draws."""

import numpy as np
import pytest
from scipy import stats

from catseye.calibration.core.quadratic_form import SumOfSquares
from catseye.calibration.core.types import Floats

ROWS = 40
RNG = np.random.default_rng(1)
EFFECTS = RNG.normal(0.0, 1.0, (ROWS, 4)) * np.array([3.0, 1.0, 0.5, 0.1])
WHITE = RNG.uniform(0.5, 2.0, ROWS)
BASIS = np.asarray(np.linalg.qr(RNG.normal(0.0, 1.0, (ROWS, 3)))[0], dtype=np.float64)
NONE = np.zeros((ROWS, 0))


def dense(white: Floats) -> Floats:
    projector = np.eye(ROWS) - BASIS @ BASIS.T
    return np.asarray(projector @ (EFFECTS @ EFFECTS.T + np.diag(white)) @ projector)


def test_the_sizes_are_the_eigenvalues_of_the_dense_covariance() -> None:
    even = np.full(ROWS, 1.5)
    found = SumOfSquares.of(EFFECTS, even, BASIS)
    expected = np.linalg.eigvalsh(dense(even))[3:]
    assert np.sort(np.repeat(found.sizes, found.counts.astype(int))) == pytest.approx(expected, rel=1e-9)


def test_the_mean_is_the_trace_where_white_errors_differ() -> None:
    assert SumOfSquares.of(EFFECTS, WHITE, BASIS).mean == pytest.approx(float(np.trace(dense(WHITE))))


def test_probabilities_of_draws_are_uniform() -> None:
    found, rng = SumOfSquares.of(EFFECTS, WHITE, BASIS), np.random.default_rng(2)
    draws = rng.multivariate_normal(np.zeros(ROWS), dense(WHITE), 2000, method="eigh")
    drawn = [found.probability(float(square)) for square in np.sum(draws**2, axis=1)]
    assert stats.kstest(drawn, "uniform").pvalue > 0.01


@pytest.mark.parametrize("share", [0.02, 0.5, 0.999, 1.0, 1.5, 3.0])
def test_errors_of_one_size_have_a_chi_square(share: float) -> None:
    found = SumOfSquares.of(NONE, np.full(ROWS, 4.0), NONE)
    assert found.dof == pytest.approx(ROWS)
    square = 4.0 * ROWS * share
    assert found.probability(square) == pytest.approx(float(stats.chi2.sf(ROWS * share, ROWS)), rel=1e-3)


def test_a_few_large_sources_are_no_chi_square() -> None:
    # One source beside 40 rows of white errors: the sum is at least what these leave.
    source = SumOfSquares.of(np.ones((ROWS, 1)), np.ones(ROWS), NONE)
    rng = np.random.default_rng(3)
    draws = rng.normal(0.0, 1.0, (20_000, ROWS)) + rng.normal(0.0, 1.0, (20_000, 1))
    squares = np.sum(draws**2, axis=1)
    for share in (0.02, 0.1, 0.5, 0.9, 0.98):
        level = float(np.quantile(squares, share))
        assert source.probability(level) == pytest.approx(1.0 - share, abs=0.02)


def test_nothing_stated_expects_nothing() -> None:
    found = SumOfSquares.of(NONE, np.zeros(ROWS), BASIS)
    assert (found.mean, found.dof, found.probability(1.0)) == (0.0, 0.0, 0.0)
