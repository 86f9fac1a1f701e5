"""Variances of components against the dense likelihood of contrasts, and against truths drawn here."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy import linalg, stats

from catseye.calibration.core import amplitudes
from catseye.calibration.core.amplitudes import (
    Compressed,
    beside_other_components,
    restricted_likelihood,
    variance_ratios,
)
from catseye.calibration.core.budget import Shared, White
from catseye.calibration.core.errors import ConvergenceError
from catseye.calibration.core.model import Parameters
from catseye.calibration.core.repeats import Repeats
from catseye.calibration.core.types import Floats

RNG = np.random.default_rng(11)
ROWS, FREE = 120, 6
JACOBIAN = RNG.normal(size=(ROWS, FREE))
COMPONENT = np.array([0, 0, 1, 1, 1, 2, -1, -1], dtype=np.int64)
CONTRIBUTOR = np.array([0, 0, 1], dtype=np.int64)
STATED = np.zeros(3, dtype=np.bool_)
ASSUMED = np.array([False, False, True])
EFFECTS = RNG.normal(size=(ROWS, COMPONENT.size))


def compressed(residuals: Floats, jacobian: Floats = JACOBIAN, effects: Floats = EFFECTS) -> Compressed:
    off = np.eye(len(jacobian)) - jacobian @ np.linalg.pinv(jacobian)
    return Compressed(effects.T @ off @ effects, effects.T @ off @ residuals, COMPONENT, CONTRIBUTOR, STATED)


def dense(residuals: Floats, logarithms: Floats) -> float:
    """Return minus the log likelihood of the contrasts that the model does not touch."""
    contrasts = linalg.null_space(JACOBIAN.T)
    ratios = np.append(np.exp(logarithms), 1.0)[COMPONENT]
    covariance = contrasts.T @ (np.eye(ROWS) + (EFFECTS * ratios) @ EFFECTS.T) @ contrasts
    return -float(stats.multivariate_normal(cov=covariance).logpdf(contrasts.T @ residuals))


def test_the_likelihood_is_that_of_the_contrasts() -> None:
    residuals = RNG.normal(size=ROWS)
    one, other = np.array([0.3, -0.4, 0.9]), np.array([-1.0, 0.2, 0.1])
    rows = compressed(residuals)
    found = restricted_likelihood(rows, one)[0] - restricted_likelihood(rows, other)[0]
    assert found == pytest.approx(dense(residuals, one) - dense(residuals, other), rel=1e-9)


def test_one_component_beside_the_others_has_their_likelihood() -> None:
    rows, at = compressed(RNG.normal(size=ROWS)), np.array([0.3, -0.4, 0.9])
    size, pull = beside_other_components(rows, at, 1)

    def alone(logarithm: float) -> float:
        grown = np.exp(logarithm) * size
        return 0.5 * float(np.sum(np.log1p(grown) - np.exp(logarithm) * pull**2 / (1.0 + grown)))

    def together(logarithm: float) -> float:
        return restricted_likelihood(rows, np.array([0.3, logarithm, 0.9]))[0]

    for logarithm in (-2.0, 0.0, 1.5):
        assert alone(logarithm) - alone(-1.0) == pytest.approx(together(logarithm) - together(-1.0), rel=1e-9)


@pytest.mark.parametrize("place", [(0.3, -0.4, 0.9), (9.2, 9.3, -0.4), (7.0, 12.0, 9.0)])
def test_slope_and_curvature_are_those_of_differences(place: tuple[float, float, float]) -> None:
    """From where ratios may grow to where they no longer do."""
    rows, at, step = compressed(1e3 * RNG.normal(size=ROWS)), np.array(place), 1e-5
    _, slope, curvature = restricted_likelihood(rows, at)
    for k, along in enumerate(np.eye(3) * step):
        ahead, behind = restricted_likelihood(rows, at + along), restricted_likelihood(rows, at - along)
        # Rounding of values around 1e7, and of slopes around 1e5, over a step of 1e-5.
        assert slope[k] == pytest.approx((ahead[0] - behind[0]) / (2 * step), rel=1e-6, abs=1e-3)
        assert curvature[k] == pytest.approx((ahead[1] - behind[1]) / (2 * step), rel=1e-5, abs=1e-4)


@pytest.mark.parametrize("truth", [(1.0, 1.0, 1.0), (9.0, 9.0, 9.0), (25.0, 25.0, 0.2)])
def test_variances_follow_the_rows(truth: tuple[float, float, float]) -> None:
    """Twelve sources a component and 600 rows say how large it is to about 40 %, 0.4 e-folds."""
    rng = np.random.default_rng(2)
    component = np.repeat([0, 1, 2], 12).astype(np.int64)
    jacobian, effects = rng.normal(size=(600, FREE)), rng.normal(size=(600, 36))
    found = []
    for _ in range(20):
        sources = rng.normal(size=36) * np.sqrt(np.array(truth)[component])
        residuals = effects @ sources + rng.normal(size=600)
        off = residuals - jacobian @ (np.linalg.pinv(jacobian) @ residuals)
        left = effects - jacobian @ (np.linalg.pinv(jacobian) @ effects)
        rows = Compressed(left.T @ left, left.T @ off, component, CONTRIBUTOR, STATED)
        found.append(np.log(variance_ratios(rows)) - np.log(truth))
    assert np.abs(np.mean(found, axis=0)).max() < 0.4


def test_rows_that_say_nothing_leave_the_stated_size() -> None:
    silent = Compressed(np.zeros((8, 8)), np.zeros(8), COMPONENT, CONTRIBUTOR, STATED)
    assert variance_ratios(silent) == pytest.approx(np.ones(3), rel=1e-6)


def test_a_size_that_is_merely_assumed_is_left_too() -> None:
    silent = Compressed(np.zeros((8, 8)), np.zeros(8), COMPONENT, CONTRIBUTOR, ASSUMED)
    assert variance_ratios(silent) == pytest.approx(np.ones(3), rel=0.01)


@pytest.mark.parametrize("truth", [0.01, 1.0, 50.0])
def test_an_assumed_size_is_found_beside_stated_ones(truth: float) -> None:
    rng = np.random.default_rng(3)
    component = np.repeat([0, 1, 2], 12).astype(np.int64)
    effects = rng.normal(size=(600, 36))
    found = []
    for _ in range(20):
        sources = rng.normal(size=36) * np.sqrt(np.array([1.0, 1.0, truth])[component])
        residuals = effects @ sources + rng.normal(size=600)
        rows = Compressed(effects.T @ effects, effects.T @ residuals, component, CONTRIBUTOR, ASSUMED)
        found.append(np.log(variance_ratios(rows)))
    off = np.mean(found, axis=0) - np.log([1.0, 1.0, truth])
    # A hundredth of the white noise's size in twelve sources is known to be small, and not how small.
    assert off[:2] == pytest.approx(np.zeros(2), abs=0.25)
    assert -0.3 < off[2] < (1.0 if truth < 0.1 else 0.5)


@pytest.mark.parametrize(("slope", "expected"), [(0.0, 1.0), (2.0, 3.4)])
def test_an_unseen_order_follows_the_spectra_of_others(slope: float, expected: float) -> None:
    """Two axes of five orders; nothing shows the first order of the second one.

    Shares fall with the order to the power of the slope; those of 1/k² are 1/1.46 of five for the first order.
    """
    rng, orders = np.random.default_rng(8), np.arange(1.0, 6.0)
    shares = 5.0 * orders**-slope / np.sum(orders**-slope)
    component = np.repeat(np.arange(10), 8)
    contributor = np.repeat([0, 1], 5)
    found = []
    for _ in range(10):
        effects = rng.normal(size=(400, 80))
        effects[:, component == 5] = 0.0
        sources = rng.normal(size=80) * np.sqrt(np.tile(shares, 2))[component]
        residuals = effects @ sources + 0.5 * rng.normal(size=400)
        stated = np.zeros(10, dtype=np.bool_)
        rows = Compressed(effects.T @ effects, effects.T @ residuals, component, contributor, stated)
        found.append(variance_ratios(rows)[5])
    # The logarithm of one axis's own share differs by about one e-fold from the other's, and the mean is above it.
    assert expected / 1.5 < np.mean(found) < 2.0 * expected


def test_nothing_to_estimate_gives_nothing() -> None:
    none = np.full(8, -1, dtype=np.int64)
    assert variance_ratios(Compressed(np.eye(8), np.ones(8), none, none[:0], STATED[:0])).size == 0


@dataclass(frozen=True)
class Lines:
    """A linear model of given rows, with one shared source of two parts."""

    matrix: Floats
    measured: Floats
    weights: Floats
    effects_mm: Floats
    stated: bool = True

    @property
    def parameters(self) -> Parameters:
        count = self.matrix.shape[1]
        return Parameters(("x",) * count, ("mm",) * count, np.eye(count))

    @property
    def repeats(self) -> Repeats:
        return Repeats.of_numbers(np.arange(self.weights.size))

    def residuals(self, values: Floats) -> Floats:
        return self.matrix @ values - self.measured

    def jacobian(self, values: Floats) -> Floats:
        return self.matrix + 0.0 * values

    def white(self, values: Floats) -> tuple[White, ...]:
        del values
        return ()

    def shared(self, values: Floats) -> tuple[Shared, ...]:
        del values
        return (Shared("both", self.effects_mm, part=np.array([0, 0, 1, 1])),)


def test_parameters_that_the_taken_rows_leave_open_are_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every third row is taken: a segment of the two rows between has none, two columns are alike."""
    monkeypatch.setattr(amplitudes, "_MOST_ROWS", 40)
    rng = np.random.default_rng(5)
    matrix = np.column_stack([rng.normal(size=(ROWS, 3)), np.zeros((ROWS, 2))])
    matrix[[31, 32], 3] = 1.0
    matrix[:, 4] = matrix[:, 0] + matrix[:, 3]
    weights = rng.uniform(0.5, 2.0, ROWS)
    rows = Lines(matrix, rng.normal(size=ROWS), weights, rng.normal(size=(ROWS, 4)))
    found = Compressed.of(rows, np.zeros(5), rows.shared(np.zeros(5)))
    some, weight = matrix[::3], weights[::3, None]
    off = np.eye(40) - (weight * some) @ np.linalg.pinv(weight * some)
    effects = weight * rows.effects_mm[::3]
    np.testing.assert_allclose(found.matrix, effects.T @ off @ effects, rtol=1e-9, atol=1e-9)
    left = off @ (-weights * rows.measured)[::3]
    assert found.vector == pytest.approx(effects.T @ left, rel=1e-9, abs=1e-9)


def test_errors_far_beyond_the_stated_ones_are_limited() -> None:
    rng = np.random.default_rng(6)
    for noise in (1e3, 1e5):
        assert variance_ratios(compressed(noise * rng.normal(size=ROWS))) == pytest.approx(np.full(3, 100.0))


def test_a_search_that_does_not_settle_is_no_result(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(amplitudes, "_MOST_STEPS", 1)
    with pytest.raises(ConvergenceError, match=r"does not settle.*state the spectrum"):
        variance_ratios(compressed(10.0 * RNG.normal(size=ROWS)))


def test_the_likelihood_is_worked_out_once_a_point(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[bytes] = []

    def counted(rows: Compressed, logarithms: Floats) -> tuple[float, Floats, Floats]:
        seen.append(logarithms.tobytes())
        return restricted_likelihood(rows, logarithms)

    rows = compressed(3.0 * RNG.normal(size=ROWS))
    monkeypatch.setattr(amplitudes, "restricted_likelihood", counted)
    variance_ratios(rows)
    # The four scales of the prior start at one and the same point.
    assert len(seen) <= len(set(seen)) + 3


def test_for_tests_an_unseen_component_stays_as_stated_on_average() -> None:
    """Five components are seen well and are as large as stated; of the sixth, another contributor's, nothing is."""
    rng, seen = np.random.default_rng(1), np.append(np.full(30, 50.0), np.zeros(6))
    component, contributor = np.repeat(np.arange(6), 6), np.array([0, 0, 0, 0, 0, 1])
    found = []
    for _ in range(40):
        vector = seen * rng.normal(size=36) + np.sqrt(seen) * rng.normal(size=36)
        rows = Compressed(np.diag(seen), vector, component, contributor, np.zeros(6, dtype=np.bool_))
        found.append(float(variance_ratios(rows, for_test=True)[-1]))
    # Forty means of five components with six sources each: 1 is known to about 4 %.
    assert float(np.mean(found)) == pytest.approx(1.0, abs=0.12)
