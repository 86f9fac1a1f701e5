"""Drift and its end, on series that are made up here."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from catseye.calibration.core.settling import drift_rate, settling

Floats = NDArray[np.float64]
TIMES_S = np.arange(0.0, 7200.0, 60.0)


def warming(time_s: Floats, amplitude_um: float, tau_s: float) -> Floats:
    """Return a distance that ends its growth by so many micrometres, mm."""
    return np.asarray(500.0 - 1e-3 * amplitude_um * np.exp(-time_s / tau_s))


def test_a_straight_drift_is_given_in_the_limits_unit() -> None:
    found = drift_rate(TIMES_S, 1.0 + 2e-6 * TIMES_S)
    assert found is not None
    # 2 nm/s are 1.2 µm in 10 min.
    assert found.um_per_10min == pytest.approx(1.2)
    assert found.u_um_per_10min == pytest.approx(0.0, abs=1e-6)
    assert found.bound_um_per_10min == pytest.approx(1.2)
    assert found.visits == TIMES_S.size


def test_its_uncertainty_is_what_repeated_draws_scatter_by() -> None:
    rng = np.random.default_rng(1)
    time_s = np.linspace(0.0, 1800.0, 31)
    series: Floats = 1.0 - 1e-6 * time_s + rng.normal(0.0, 0.010, (800, 31))
    found = [drift_rate(time_s, series[k]) for k in range(800)]
    rates = [one.um_per_10min for one in found if one is not None]
    stated = math.sqrt(np.mean([one.u_um_per_10min**2 for one in found if one is not None]))
    assert float(np.mean(rates)) == pytest.approx(-0.6, abs=0.25)
    assert stated == pytest.approx(float(np.std(rates)), rel=0.1)
    # 10 µm over 31 visits in 30 min: σ / sqrt(Σ (t − t̄)²) = 10 / (60 sqrt(2480)) µm/s.
    assert stated == pytest.approx(10.0 / (60.0 * math.sqrt(2480.0)) * 600.0, rel=0.05)


def test_too_few_visits_or_no_time_have_no_drift() -> None:
    assert drift_rate(TIMES_S[:3], np.zeros(3)) is None
    assert drift_rate(np.zeros(10), np.arange(10.0)) is None
    assert settling(np.zeros(10), np.arange(10.0)) is None


@pytest.mark.parametrize("start_s", [0.0, 500.0])
def test_an_exponential_approach_predicts_its_end(start_s: float) -> None:
    rng = np.random.default_rng(2)
    time_s = TIMES_S + start_s
    found = settling(time_s, warming(time_s, 80.0, 1800.0) + rng.normal(0.0, 0.001, time_s.size))
    assert found is not None
    assert found.time_constant_s == pytest.approx(1800.0, rel=0.1)
    # Slope 80 µm / 1800 s exp(−t/1800 s) = 5 µm / 600 s.
    assert found.below_after_s(5.0) == pytest.approx(1800.0 * math.log(80.0 / 1800.0 * 600.0 / 5.0), rel=0.05)
    assert found.below_after_s(1e6) == 0.0


def test_a_straight_line_or_mere_scatter_has_no_end() -> None:
    rng = np.random.default_rng(3)
    claimed = 0
    for _ in range(60):
        noise = rng.normal(0.0, 0.005, TIMES_S.size)
        claimed += settling(TIMES_S, 1e-6 * TIMES_S + noise) is not None
        claimed += settling(TIMES_S, noise) is not None
    # At a significance of 1 %, and a time constant that may be chosen.
    assert claimed <= 8
