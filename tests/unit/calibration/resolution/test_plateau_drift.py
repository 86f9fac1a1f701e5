"""Drifts that a minute of standstill does not tell, in recordings of joints whose errors are written down."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.decaying import DecayingTest, decaying_test
from catseye.calibration.resolution.flags import doubts
from catseye.calibration.resolution.recording import recording_of
from catseye.calibration.resolution.steps import Steps, steps
from tests.unit.calibration.resolution.staircase import DEG, STEPS_DEG, Bench

BENCH = Bench(rate_hz=25.0, noise=5e-6 * DEG)
MOVES = BENCH.moves(STEPS_DEG * DEG)
MEAN_PERCENT: Floats = -12.0 * 3e-4 / STEPS_DEG
PHASES = (0.0, 0.5 * np.pi, np.pi, 1.5 * np.pi)


def drifting(
    amplitude_deg: float, period_s: float, phase: float, creep_deg_s: float = 0.0, seed: int = 3
) -> Steps:
    """Return steps of a joint with 3 % of scatter, by optics that sway, and that creeps on behind each move."""
    scatter = np.random.default_rng(12).normal(0.0, 3.0, STEPS_DEG.size)
    done = MOVES.command * (1.0 + (MEAN_PERCENT + scatter) / 100.0)
    time_s, position = BENCH.samples(MOVES, done, seed)
    position += amplitude_deg * DEG * np.sin(2.0 * np.pi * (time_s - 32.0) / period_s + phase)
    position += creep_deg_s * DEG * np.clip(time_s - MOVES.time_s[0], 0.0, None)
    return steps(recording_of(time_s, position, "rad"), MOVES)


def true_least_step() -> float:
    """Return the least step by the paper's rule, written out, rad."""
    means = [abs(float(np.mean(MEAN_PERCENT[max(0, k - 5) : k + 6]))) for k in range(STEPS_DEG.size)]
    return float(MOVES.command[int(np.argmax(np.array(means) > 10.0)) - 1])


def named(found: DecayingTest) -> list[str]:
    return [flag.kind for flag in doubts(found.flags, ())]


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize(("amplitude_deg", "period_s"), [(1e-4, 240.0), (5e-5, 240.0)])
def test_a_drift_that_sways_is_in_the_interval(amplitude_deg: float, period_s: float, phase: float) -> None:
    found = decaying_test(drifting(amplitude_deg, period_s, phase))
    assert found.least_step is not None
    assert found.least_step.low <= true_least_step() <= found.least_step.high
    assert named(found) == ["changing-drift"]


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize(("amplitude_deg", "period_s"), [(1e-4, 600.0), (3e-5, 180.0)])
def test_a_slow_or_small_sway_is_in_the_interval(amplitude_deg: float, period_s: float, phase: float) -> None:
    least = decaying_test(drifting(amplitude_deg, period_s, phase)).least_step
    assert least is not None
    assert least.low <= true_least_step() <= least.high


@pytest.mark.parametrize("phase", PHASES)
def test_the_u_of_steps_knows_a_drift_that_sways(phase: float) -> None:
    found = drifting(1e-4, 240.0, phase)
    sways = 5.0 * 1e-4 * DEG * 2.0 * np.pi / 240.0 / np.sqrt(2.0)
    assert 0.7 * sways < found.u[-1] < 2.0 * sways


def test_a_standstill_against_the_plateaus_gives_way() -> None:
    # The drift of the minute before the test ends with it.
    done = MOVES.command * (1.0 + MEAN_PERCENT / 100.0)
    time_s, position = BENCH.samples(MOVES, done)
    position += 2e-6 * DEG * np.minimum(time_s, MOVES.time_s[0])
    found = steps(recording_of(time_s, position, "rad"), MOVES)
    assert "changing-drift" in named(decaying_test(found))
    assert abs(found.noise.drift_per_s) < 3.0 * found.noise.u_drift_per_s
    assert found.noise.u_drift_per_s < 4e-7 * DEG
    # What is said to be subtracted is what is subtracted.
    assert not any("while the arm stands still" in flag.text for flag in found.noise.flags)


@pytest.mark.parametrize("seed", range(10))
def test_a_steady_drift_is_no_doubt(seed: int) -> None:
    bench = replace(BENCH, drift_per_s=2e-6 * DEG)
    found = steps(bench.recorded(MOVES, MOVES.command, seed), MOVES)
    assert named(decaying_test(found)) == []
    assert found.noise.drift_per_s == pytest.approx(2e-6 * DEG, rel=0.05)


@pytest.mark.parametrize("seed", range(10))
def test_creep_behind_moves_is_no_doubt(seed: int) -> None:
    found = drifting(0.0, 240.0, 0.0, creep_deg_s=4e-6, seed=seed)
    assert named(decaying_test(found)) == []
    assert abs(found.noise.drift_per_s) < 1e-7 * DEG


def test_a_drift_below_u_of_a_step_is_no_flag() -> None:
    bench = replace(BENCH, drift_per_s=5e-8 * DEG)
    assert steps(bench.recorded(MOVES, MOVES.command), MOVES).flags == ()


def test_the_u_of_the_drift_is_in_the_interval() -> None:
    found = drifting(0.0, 240.0, 0.0)
    unsure = replace(found, noise=replace(found.noise, u_drift_per_s=2e-6 * DEG))
    sure, wide = decaying_test(found).least_step, decaying_test(unsure).least_step
    assert sure is not None
    assert wide is not None
    assert wide.u > 1.5 * sure.u
