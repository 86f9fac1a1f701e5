"""Propagation of distributions on the published examples of JCGM 101, where the first order fails too."""

import math

import numpy as np
import pytest
from scipy import stats

from catseye.calibration.core.coverage import (
    Interval,
    fewest_draws,
    numerical_tolerance,
    shortest_interval,
    symmetric_interval,
    validate,
)
from catseye.calibration.core.distributions import (
    Bounded,
    CurvilinearTrapezoid,
    Distribution,
    Normal,
    StudentT,
)
from catseye.calibration.core.errors import ConvergenceError
from catseye.calibration.core.propagation import coverage_factor, independent, propagate
from catseye.calibration.core.types import Floats
from catseye.calibration.uncertainty.monte_carlo import propagate_distributions, until_stable

DRAWS = 400_000


def added(x: Floats) -> Floats:
    return np.asarray(x.sum(axis=0))


def rectangular(u: float) -> Bounded:
    return Bounded(0.0, u * math.sqrt(3.0), "uniform")


@pytest.mark.parametrize(
    ("inputs", "u", "half"),
    [
        ([Normal(0.0, 1.0)] * 4, 2.0, 3.92),
        ([rectangular(1.0)] * 4, 2.0, 3.88),
        ([rectangular(1.0)] * 3 + [rectangular(10.0)], 10.15, 17.0),
    ],
)
def test_additive_models_of_s1_9_2(inputs: list[Distribution], u: float, half: float) -> None:
    draws = propagate_distributions(added, inputs, DRAWS, 1)
    assert float(draws.std()) == pytest.approx(u, rel=0.004)
    interval = symmetric_interval(draws, 0.95)
    assert [-interval.low, interval.high] == pytest.approx([half, half], rel=0.006)


def mass(x: Floats) -> Floats:
    """S1 9.3: deviation of a weight's conventional mass from 100 g, mg."""
    reference, small, air, weight, standard = x
    buoyancy = 1.0 + (air - 1.2) * (1.0 / weight - 1.0 / standard)
    return np.asarray(((reference + small) * buoyancy - 100_000.0)[None])


MASS: list[Distribution] = [
    Normal(100_000.0, 0.050),
    Normal(1.234, 0.020),
    Bounded(1.20, 0.10),
    Bounded(8e3, 1e3),
    Bounded(8e3, 0.05e3),
]


def test_mass_of_s1_9_3_where_first_order_is_forty_percent_short() -> None:
    draws = propagate_distributions(mass, MASS, DRAWS, 2)[0]
    first_order = propagate(
        mass, independent(*(np.array([getattr(d, k) for d in MASS]) for k in ("mean", "u")))
    )
    assert float(draws.mean()) == pytest.approx(1.2340, abs=4e-4)
    assert float(draws.std()) == pytest.approx(0.0755, abs=2e-4)
    symmetric, shortest = symmetric_interval(draws, 0.95), shortest_interval(draws, 0.95)
    assert [symmetric.low, symmetric.high] == pytest.approx([1.0845, 1.3835], abs=1e-3)
    # The density is symmetric and flat at the limits: the shortest interval may lie a little to either side.
    assert shortest.high - shortest.low == pytest.approx(0.2990, abs=1e-3)
    assert first_order.u[0] == pytest.approx(0.0539, abs=1e-4)
    half = float(coverage_factor(0.95, math.inf)) * first_order.u[0]
    value = first_order.values[0]
    verdict = validate(Interval(value - half, value + half), draws, 0.95, float(draws.std()))
    assert verdict.verdict == "not validated"
    assert verdict.tolerance == pytest.approx(0.005)
    assert verdict.difference == pytest.approx(0.045, abs=0.005)


def squares(x: Floats) -> Floats:
    return np.asarray((x**2).sum(axis=0))


@pytest.mark.parametrize(
    ("x1", "mean", "u", "low", "high"),
    [(0.0, 50, 50, 0, 150), (0.010, 150, 112, 0, 366), (0.050, 2550, 502, 1589, 3543)],
)
def test_microwave_loss_of_s1_9_4(x1: float, mean: float, u: float, low: float, high: float) -> None:
    draws = 1e6 * propagate_distributions(squares, [Normal(x1, 0.005), Normal(0.0, 0.005)], DRAWS, 3)
    assert float(draws.mean()) == pytest.approx(mean, rel=0.005)
    assert float(draws.std()) == pytest.approx(u, rel=0.008)
    shortest = shortest_interval(draws, 0.95)
    assert shortest.low == pytest.approx(low, abs=12 if low else 0.5)
    assert shortest.high == pytest.approx(high, abs=12 if low else 3)


def test_first_order_has_no_uncertainty_at_all_where_s1_9_4_has_one() -> None:
    inputs = independent(np.zeros(2), np.full(2, 0.005))
    assert propagate(lambda x: np.array([x @ x]), inputs).u[0] == pytest.approx(0.0, abs=1e-15)


def gauge_block(x: Floats) -> Floats:
    """S1 9.5: deviation of a gauge block from 50 mm, nm."""
    standard, mean, random, systematic, alpha, mean_temperature, cyclic, d_alpha, d_theta = x
    expansion = d_alpha * (mean_temperature + cyclic) + alpha * d_theta
    return np.asarray(standard + mean + random + systematic - standard * expansion - 50e6)


GAUGE_BLOCK: list[Distribution] = [
    StudentT(50_000_623.0, 25.0, 18.0),
    StudentT(215.0, 6.0, 24.0),
    StudentT(0.0, 4.0, 5.0),
    StudentT(0.0, 7.0, 8.0),
    Bounded(11.5e-6, 2e-6),
    Normal(-0.1, 0.2),
    Bounded(0.0, 0.5, "arcsine"),
    CurvilinearTrapezoid(0.0, 1.0e-6, 0.1e-6),
    CurvilinearTrapezoid(0.0, 0.050, 0.025),
]


def test_gauge_block_of_s1_9_5() -> None:
    draws = propagate_distributions(gauge_block, GAUGE_BLOCK, DRAWS, 4)
    assert float(draws.mean()) == pytest.approx(838.0, abs=0.3)
    assert float(draws.std()) == pytest.approx(35.8, abs=0.2)
    shortest = shortest_interval(draws, 0.99)
    # Published [745, 932] from fewer draws; recomputed [744, 931].
    assert [shortest.low, shortest.high] == pytest.approx([744.5, 931.5], abs=2.0)


def test_a_linear_normal_model_is_validated() -> None:
    draws = propagate_distributions(added, [Normal(0.0, 1.0)] * 4, DRAWS, 5)
    half = 2.0 * stats.norm.ppf(0.975)
    one = validate(Interval(-half, half), draws, 0.95, 2.0)
    assert (one.verdict, one.tolerance) == ("validated", 0.5)
    assert validate(Interval(-half, half), draws, 0.95, 2.0, digits=2).tolerance == pytest.approx(0.05)


def test_few_draws_leave_the_verdict_open() -> None:
    draws = propagate_distributions(added, [Normal(0.0, 1.0)], 300, 6)
    half = float(symmetric_interval(draws, 0.95).high) + 0.06
    one = validate(Interval(-half, half), draws, 0.95, 0.94)
    assert one.tolerance == pytest.approx(0.05)
    assert one.verdict == "too few draws"


def test_the_sampling_of_a_limit_is_that_of_repeated_draws() -> None:
    half = stats.norm.ppf(0.975)
    limits, stated = [], []
    for seed in range(200):
        draws = propagate_distributions(added, [Normal(0.0, 1.0)], 4000, seed)
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


def test_blocks_are_drawn_until_the_digits_stand() -> None:
    found = until_stable(added, [Normal(0.0, 3.0), Normal(0.0, 4.0)], seed=8, digits=1)
    assert found.tolerance == 0.5
    assert found.draws.size == 20_000
    more = until_stable(added, [Normal(0.0, 3.0), Normal(0.0, 4.0)], seed=8, digits=2)
    assert more.tolerance == pytest.approx(0.05)
    assert more.draws.size > 50_000
    assert more.mean == pytest.approx(0.0, abs=0.05)
    assert more.u == pytest.approx(5.0, abs=0.05)
    assert [more.symmetric.low, more.symmetric.high] == pytest.approx([-9.80, 9.80], abs=0.05)
    assert more.shortest.high - more.shortest.low <= more.symmetric.high - more.symmetric.low


def test_blocks_that_never_settle_are_refused() -> None:
    with pytest.raises(ConvergenceError, match="no standard deviation"):
        until_stable(added, [StudentT(0.0, 1.0, 1.0)], seed=9, digits=2, most_blocks=20)


def test_the_seed_decides_the_draws() -> None:
    one, again, other = (propagate_distributions(added, [Normal(0.0, 1.0)], 100, seed) for seed in (1, 1, 2))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)
