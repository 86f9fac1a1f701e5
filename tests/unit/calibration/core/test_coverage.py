"""Coverage on the published examples of the GUM and of JCGM 101; GTC is the oracle of the first order."""

import math
from collections.abc import Callable

import GTC
import numpy as np
import pytest
from GTC.type_b import arcsine, uniform
from hypothesis import given
from hypothesis import strategies as st
from scipy import linalg, stats

from catseye.calibration.core.coverage import (
    Interval,
    correlation,
    coverage_factor,
    effective_dof,
    fewest_draws,
    numerical_tolerance,
    shortest_interval,
    symmetric_interval,
    validate,
)
from catseye.calibration.core.types import Floats

DRAWS = 400_000

Draw = Callable[[np.random.Generator], Floats]


def normal(mean: float, u: float) -> Draw:
    return lambda rng: rng.normal(mean, u, DRAWS)


def rectangular(mean: float, half_width: float) -> Draw:
    return lambda rng: rng.uniform(mean - half_width, mean + half_width, DRAWS)


def student(mean: float, scale: float, dof: float) -> Draw:
    return lambda rng: mean + scale * rng.standard_t(dof, DRAWS)


def curvilinear(half_width: float, margin: float) -> Draw:
    """Uniform about 0 within a half width that is itself uniform within a margin."""
    return lambda rng: (
        rng.uniform(half_width - margin, half_width + margin, DRAWS) * rng.uniform(-1, 1, DRAWS)
    )


def drawn(inputs: list[Draw], seed: int) -> Floats:
    """Return draws of the inputs, shape (inputs, DRAWS)."""
    rng = np.random.default_rng(seed)
    return np.stack([one(rng) for one in inputs])


@pytest.mark.parametrize(
    ("inputs", "u", "half"),
    [
        ([normal(0.0, 1.0)] * 4, 2.0, 3.92),
        ([rectangular(0.0, 3**0.5)] * 4, 2.0, 3.88),
        ([rectangular(0.0, 3**0.5)] * 3 + [rectangular(0.0, 10.0 * 3**0.5)], 10.15, 17.0),
    ],
)
def test_additive_models_of_s1_9_2(inputs: list[Draw], u: float, half: float) -> None:
    draws = drawn(inputs, 1).sum(axis=0)
    assert float(draws.std()) == pytest.approx(u, rel=0.004)
    interval = symmetric_interval(draws, 0.95)
    assert [-interval.low, interval.high] == pytest.approx([half, half], rel=0.006)


def test_s1_9_3_mass_calibration_is_reproduced() -> None:
    """Deviation of a weight's conventional mass from 100 g, mg."""
    inputs = [
        normal(100_000.0, 0.050),
        normal(1.234, 0.020),
        rectangular(1.20, 0.10),
        rectangular(8e3, 1e3),
        rectangular(8e3, 0.05e3),
    ]
    reference, small, air, weight, standard = drawn(inputs, 2)
    draws = (reference + small) * (1.0 + (air - 1.2) * (1.0 / weight - 1.0 / standard)) - 100_000.0
    assert float(draws.mean()) == pytest.approx(1.2340, abs=4e-4)
    assert float(draws.std()) == pytest.approx(0.0755, abs=2e-4)
    symmetric, shortest = symmetric_interval(draws, 0.95), shortest_interval(draws, 0.95)
    assert [symmetric.low, symmetric.high] == pytest.approx([1.0845, 1.3835], abs=1e-3)
    # The density is symmetric and flat at the limits: the shortest interval may lie a little to either side.
    assert shortest.high - shortest.low == pytest.approx(0.2990, abs=1e-3)
    mass = GTC.ureal(100_000.0, 0.050) + GTC.ureal(1.234, 0.020)
    buoyancy = GTC.ureal(1.2, uniform(0.1)) - 1.2
    inverse = 1.0 / GTC.ureal(8e3, uniform(1e3)) - 1.0 / GTC.ureal(8e3, uniform(0.05e3))
    first = mass * (1.0 + buoyancy * inverse) - 100_000.0
    assert first.u == pytest.approx(0.0539, abs=1e-4)
    half = float(coverage_factor(0.95, math.inf)) * first.u
    verdict = validate(Interval(first.x - half, first.x + half), draws, 0.95, float(draws.std()))
    assert verdict.verdict == "not validated"
    assert verdict.tolerance == pytest.approx(0.005)
    assert verdict.difference == pytest.approx(0.045, abs=0.005)


@pytest.mark.parametrize(
    ("x1", "mean", "u", "low", "high"),
    [(0.0, 50, 50, 0, 150), (0.010, 150, 112, 0, 366), (0.050, 2550, 502, 1589, 3543)],
)
def test_microwave_loss_of_s1_9_4(x1: float, mean: float, u: float, low: float, high: float) -> None:
    draws = 1e6 * np.sum(drawn([normal(x1, 0.005), normal(0.0, 0.005)], 3) ** 2, axis=0)
    assert float(draws.mean()) == pytest.approx(mean, rel=0.005)
    assert float(draws.std()) == pytest.approx(u, rel=0.008)
    shortest = shortest_interval(draws, 0.95)
    assert shortest.low == pytest.approx(low, abs=12 if low else 0.5)
    assert shortest.high == pytest.approx(high, abs=12 if low else 3)


def test_gauge_block_of_s1_9_5() -> None:
    """Deviation of a gauge block from 50 mm, nm."""
    standard, mean, random, systematic, alpha, temperature, d_alpha, d_theta = drawn(
        [
            student(50_000_623.0, 25.0, 18.0),
            student(215.0, 6.0, 24.0),
            student(0.0, 4.0, 5.0),
            student(0.0, 7.0, 8.0),
            rectangular(11.5e-6, 2e-6),
            normal(-0.1, 0.2),
            curvilinear(1.0e-6, 0.1e-6),
            curvilinear(0.050, 0.025),
        ],
        4,
    )
    cyclic = 0.5 * np.sin(2.0 * np.pi * np.random.default_rng(5).random(DRAWS))
    expansion = d_alpha * (temperature + cyclic) + alpha * d_theta
    draws = standard + mean + random + systematic - standard * expansion - 50e6
    assert float(draws.mean()) == pytest.approx(838.0, abs=0.3)
    assert float(draws.std()) == pytest.approx(35.8, abs=0.2)
    shortest = shortest_interval(draws, 0.99)
    # Published [745, 932] from fewer draws; recomputed [744, 931].
    assert [shortest.low, shortest.high] == pytest.approx([744.5, 931.5], abs=2.0)


def test_a_linear_normal_model_is_validated() -> None:
    draws = drawn([normal(0.0, 1.0)] * 4, 5).sum(axis=0)
    half = 2.0 * stats.norm.ppf(0.975)
    one = validate(Interval(-half, half), draws, 0.95, 2.0)
    assert (one.verdict, one.tolerance) == ("validated", 0.5)
    assert validate(Interval(-half, half), draws, 0.95, 2.0, digits=2).tolerance == pytest.approx(0.05)


def test_few_draws_leave_the_verdict_open() -> None:
    draws = np.random.default_rng(6).standard_normal(300)
    half = float(symmetric_interval(draws, 0.95).high) + 0.06
    one = validate(Interval(-half, half), draws, 0.95, 0.94)
    assert one.tolerance == pytest.approx(0.05)
    assert one.verdict == "too few draws"


def test_the_sampling_of_a_limit_is_that_of_repeated_draws() -> None:
    half = stats.norm.ppf(0.975)
    limits, stated = [], []
    for seed in range(200):
        draws = np.random.default_rng(seed).standard_normal(4000)
        one = validate(Interval(-half, half), draws, 0.95, 1.0)
        limits.append(one.drawn.high)
        stated.append(one.sampling)
    # The larger of two limits' scatters is stated, so it may be somewhat more than that of one.
    assert float(np.mean(stated)) == pytest.approx(2.0 * float(np.std(limits)), rel=0.25)


def test_interval_ends_are_order_statistics() -> None:
    draws = np.random.default_rng(7).permutation(np.arange(1.0, 101.0))
    # 95 of 100: five draws are outside, three below and two above.
    assert symmetric_interval(draws, 0.95) == Interval(3.0, 98.0)
    skewed = draws**2
    assert shortest_interval(skewed, 0.95) == Interval(1.0, 96.0**2)
    with pytest.raises(ValueError, match="hold no interval"):
        symmetric_interval(draws[:5], 0.95)


@pytest.mark.parametrize(
    ("u", "digits", "tolerance"),
    [(0.0754, 2, 0.0005), (0.0754, 1, 0.005), (32.0, 2, 0.5), (9.96, 2, 0.5), (0.99, 1, 0.5), (0.0, 1, 0.0)],
)
def test_numerical_tolerance(u: float, digits: int, tolerance: float) -> None:
    assert numerical_tolerance(u, digits) == pytest.approx(tolerance)


@pytest.mark.parametrize(("coverage", "draws"), [(0.95, 2000), (0.99, 10_000), (0.9, 1000)])
def test_fewest_draws(coverage: float, draws: int) -> None:
    assert fewest_draws(coverage) == draws


def test_effective_dof_of_the_end_gauge_of_gum_h1() -> None:
    """Length of an end gauge by comparison, nm; published: u 32 nm, 16 degrees of freedom, U99 93 nm."""
    inputs = [
        GTC.ureal(50_000_623.0, 25.0, 18),
        GTC.ureal(215.0, 5.8, 24),
        GTC.ureal(0.0, 3.9, 5),
        GTC.ureal(0.0, 6.7, 8),
        GTC.ureal(11.5e-6, uniform(2e-6)),
        GTC.ureal(0.0, uniform(1e-6), 50),
        GTC.ureal(-0.1, 0.2),
        GTC.ureal(0.0, arcsine(0.5)),
        GTC.ureal(0.0, uniform(0.05), 2),
    ]
    standard, mean, random, systematic, alpha, d_alpha, temperature, cyclic, d_theta = inputs
    expansion = d_alpha * (temperature + cyclic) + alpha * d_theta
    length = standard + mean + random + systematic - standard * expansion
    parts = np.array([GTC.component(length, one) for one in inputs])
    dof = effective_dof(parts, np.array([one.df for one in inputs]))
    assert length.u == pytest.approx(31.7, abs=0.05)
    assert dof == pytest.approx(16.75, abs=0.05)
    assert dof == pytest.approx(length.df, rel=1e-9)
    # The published 93 nm takes u = 32 nm, rounded up, and the next lower whole number of degrees of freedom.
    assert round(32.0 * float(coverage_factor(0.99, math.floor(dof)))) == 93


def test_correlated_means_of_gum_h2_keep_their_samples_dof() -> None:
    """Impedance from five simultaneous readings of voltage, current and phase; published: u, and n − 1 = 4."""
    v, i, phi = np.array(
        [
            [5.007, 4.994, 5.005, 4.990, 4.999],
            [19.663e-3, 19.639e-3, 19.640e-3, 19.685e-3, 19.678e-3],
            [1.0456, 1.0438, 1.0468, 1.0428, 1.0433],
        ]
    )
    together = np.cov([v, i, phi]) / v.size
    u, between = np.sqrt(np.diag(together)), np.corrcoef([v, i, phi])
    z, angle = v.mean() / i.mean(), phi.mean()
    cos, sin = math.cos(angle), math.sin(angle)
    slopes = {
        0.071: np.array([cos / i.mean(), -z * cos / i.mean(), -z * sin]),
        0.295: np.array([sin / i.mean(), -z * sin / i.mean(), z * cos]),
        0.236: np.array([1.0 / i.mean(), -z / i.mean(), 0.0]),
    }
    for published, slope in slopes.items():
        parts = slope * u
        # The published ones come from rounded means, uncertainties and coefficients.
        assert math.sqrt(parts @ between @ parts) == pytest.approx(published, abs=1e-3)
        assert effective_dof(parts, np.full(3, 4.0), between) == pytest.approx(4.0, rel=1e-12)


def test_the_line_of_gum_h3_keeps_its_fits_dof() -> None:
    """Correction of a thermometer at 30 °C from a line through eleven readings; published: 4.1 m°C, 9."""
    t = np.array([21.521, 22.012, 22.512, 23.003, 23.507, 23.999, 24.513, 25.002, 25.503, 26.010, 26.511])
    b = np.array([-171, -169, -166, -159, -164, -165, -156, -157, -159, -161, -160]) * 1e-3
    intercept, slope = GTC.type_a.line_fit(t - 20.0, b).a_b
    correction = intercept + 10.0 * slope
    parts = np.array([intercept.u, 10.0 * slope.u])
    r = float(GTC.get_correlation(intercept, slope))
    between = np.array([[1.0, r], [r, 1.0]])
    assert float(correction.x) == pytest.approx(-0.1494, abs=5e-5)
    assert math.sqrt(parts @ between @ parts) == pytest.approx(0.0041, abs=5e-5)
    assert r == pytest.approx(-0.930, abs=5e-4)
    assert effective_dof(parts, np.full(2, 9.0), between) == pytest.approx(9.0, rel=1e-12)
    # Another input that is independent of both enters as the formula has it.
    whole = effective_dof(
        np.append(parts, 0.003), np.array([9.0, 9.0, 20.0]), linalg.block_diag(between, np.eye(1))
    )
    stated = correction + GTC.ureal(0.0, 0.003, 20)
    assert whole == pytest.approx(float(stated.df), rel=1e-9)


def test_correlations_are_those_of_gtc() -> None:
    one, other, none = GTC.ureal(1.0, 3.0), GTC.ureal(1.0, 4.0), GTC.constant(1.0)
    results = [one + other, one - other, none]
    covariance = np.array([[GTC.get_covariance(a, b) for b in results] for a in results])
    expected = GTC.get_correlation(results[0], results[1])
    assert correlation(covariance) == pytest.approx(
        np.array([[1.0, expected, 0.0], [expected, 1.0, 0.0], [0.0, 0.0, 1.0]])
    )


@pytest.mark.parametrize(("dof", "k"), [(1, 12.71), (4, 2.78), (10, 2.23), (50, 2.01), (math.inf, 1.960)])
def test_coverage_factors_of_the_t_table(dof: float, k: float) -> None:
    assert float(coverage_factor(0.95, dof)) == pytest.approx(k, abs=0.006)


@given(
    st.lists(st.tuples(st.floats(1e-3, 1e3), st.floats(1.0, 1e4)), min_size=1, max_size=8),
)
def test_effective_dof_lie_between_the_smallest_and_the_sum(parts: list[tuple[float, float]]) -> None:
    u, dof = (np.array(column) for column in zip(*parts, strict=True))
    found = effective_dof(u, dof)
    assert dof.min() * (1 - 1e-9) <= found <= dof.sum() * (1 + 1e-9)
