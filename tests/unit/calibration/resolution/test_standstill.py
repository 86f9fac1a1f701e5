"""Noise and drift of recordings whose noise is known."""

import math

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import RecordingError
from catseye.calibration.resolution.recording import Recording
from catseye.calibration.resolution.standstill import Standstill, standstill

RATE_HZ = 100.0


def found(position: Floats) -> Standstill:
    return standstill(Recording(0.0, RATE_HZ, position, "rad"))


def white(seed: int, seconds: float = 60.0) -> Floats:
    return np.random.default_rng(seed).normal(0.0, 2e-6, round(seconds * RATE_HZ))


def correlated(seed: int) -> Floats:
    """Return noise whose correlation falls by e in 1 s, with the σ of `white`."""
    rng, share = np.random.default_rng(seed), math.exp(-1.0 / RATE_HZ)
    values = np.empty(round(60.0 * RATE_HZ))
    values[0] = rng.normal(0.0, 2e-6)
    for k, push in enumerate(rng.normal(0.0, 2e-6 * math.sqrt(1.0 - share**2), values.size - 1)):
        values[k + 1] = share * values[k] + push
    return values


def test_white_noise_averages_out_with_the_square_root() -> None:
    many = [found(white(seed)) for seed in range(20)]
    assert np.mean([one.sigma for one in many]) == pytest.approx(2e-6, rel=0.02)
    assert np.mean([one.u_of_step(2.0, 5.0) for one in many]) == pytest.approx(
        2e-6 * math.sqrt(2.0 / 200.0), rel=0.1
    )


def test_correlated_noise_averages_out_as_its_correlation_says() -> None:
    # Variance of a mean over T of a process with correlation exp(−t/τ): 2 (τ/T)² (T/τ − 1 + exp(−T/τ)); what two
    # means 5 s apart share is (τ/T)² (1 − exp(−T/τ))² exp(−(5 − T)/τ).
    t = 2.0
    variance = 2.0 / t**2 * (t - 1.0 + math.exp(-t)) - (1.0 - math.exp(-t)) ** 2 / t**2 * math.exp(t - 5.0)
    squares = [found(correlated(seed)).u_of_step(2.0, 5.0) ** 2 for seed in range(40)]
    assert math.sqrt(float(np.mean(squares))) == pytest.approx(2e-6 * math.sqrt(2.0 * variance), rel=0.1)


def test_a_drift_is_found_within_its_uncertainty() -> None:
    drift = 1e-7
    errors = []
    for seed in range(60):
        one = found(white(seed) + drift * np.arange(6000) / RATE_HZ)
        assert one.significant
        errors.append((one.drift_per_s - drift) / one.u_drift_per_s)
    # 10 degrees of freedom: t has a variance of 1.25.
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(1.12, abs=0.2)


def test_noise_alone_is_seldom_a_drift() -> None:
    assert sum(found(white(seed)).significant for seed in range(300)) <= 9


def settling(seed: int, drift: float, seconds: float = 15.0) -> Floats:
    """Return a joint that creeps on by 3.5e-7 rad after a motion, with 4 s to a factor e, in noise and drift."""
    times_s = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    return white(seed, seconds) + drift * times_s - 3.5e-7 * np.exp(-times_s / 4.0)


@pytest.mark.parametrize("drift", [0.0, 5e-8])
def test_creep_after_a_motion_is_no_drift(drift: float) -> None:
    many = [found(settling(seed, drift)) for seed in range(100)]
    errors = [(one.drift_per_s - drift) / one.u_drift_per_s for one in many]
    assert abs(np.mean(errors)) < 0.5
    # That the time constant is not known is in u, too.
    assert 0.6 < np.sqrt(np.mean(np.square(errors))) < 1.2


def test_a_short_standstill_is_refused() -> None:
    with pytest.raises(RecordingError, match="lasts 9 s"):
        found(white(1, 9.0))
