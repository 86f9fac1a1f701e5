"""Counters whose step is written down here: found, and part of what a step is known to."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.quantum import quantum
from catseye.calibration.resolution.recording import recording_of
from catseye.calibration.resolution.steps import Steps, steps
from tests.unit.calibration.resolution.staircase import DEG, STEPS_DEG, Bench

SPACING_MM = 30.0


def counted(noise_mm: float, quantum_mm: float, lead_s: float = 62.0) -> Steps:
    """Return steps of a joint that does what it was commanded, by a counter that rounds."""
    bench = Bench(noise=0.0, lead_s=lead_s)
    command = STEPS_DEG * DEG
    moves = bench.moves(command)
    time_s, angle = bench.samples(moves, command)
    length_mm = SPACING_MM * np.sin(angle) + 0.3 * quantum_mm
    length_mm = length_mm + np.random.default_rng(3).normal(0.0, noise_mm, length_mm.size)
    length_mm = quantum_mm * np.round(length_mm / quantum_mm)
    return steps(recording_of(time_s, np.arcsin(length_mm / SPACING_MM), "rad"), moves)


def kinds(found: Steps) -> set[str]:
    return {flag.kind for flag in found.flags}


@given(step=st.floats(1e-7, 1e-3), noise=st.floats(0.3, 3.0), seed=st.integers(0, 99))
def test_the_step_of_a_counter_is_found(step: float, noise: float, seed: int) -> None:
    values = np.round(np.random.default_rng(seed).normal(0.0, noise, 2000))
    assert quantum(step * values) == pytest.approx(step, rel=1e-6)


@pytest.mark.parametrize(
    "values",
    [
        np.random.default_rng(1).normal(size=5000),
        np.cumsum(np.random.default_rng(2).normal(size=5000)),
        np.sin(np.linspace(0.0, 3.0, 5000)),
        np.zeros(5000),
    ],
)
def test_a_signal_without_steps_has_no_quantum(values: Floats) -> None:
    assert quantum(values) == 0.0


@pytest.mark.parametrize("lead_s", [62.0, 5.0])
def test_a_coarse_quiet_counter_limits_what_is_judged(lead_s: float) -> None:
    found = counted(noise_mm=8e-6, quantum_mm=1e-4, lead_s=lead_s)
    least = 1e-4 / SPACING_MM / math.sqrt(6.0)
    assert found.noise.step == pytest.approx(least, rel=0.01)
    assert "quantised" in kinds(found)
    assert not found.judged[2.95 * least > STEPS_DEG * DEG].any()
    assert found.judged[3.05 * least < STEPS_DEG * DEG].all()


def test_errors_of_rounded_steps_keep_within_their_u() -> None:
    found = counted(noise_mm=8e-6, quantum_mm=1e-4)
    z = (found.measured - found.moves.command) / found.u
    # Rounding is uniform: its sum of two is at most √6 standard deviations from 0.
    assert np.abs(z).max() < math.sqrt(6.0)
    assert 0.4 < float(np.sqrt(np.mean(z**2))) < 1.3


def test_noise_above_the_step_averages_rounding_out() -> None:
    found = counted(noise_mm=1e-4, quantum_mm=1e-4)
    assert "quantised" not in kinds(found)
    assert found.noise.step < 0.5 * 1e-4 / SPACING_MM / math.sqrt(6.0)
