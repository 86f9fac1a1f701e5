"""Glitches in recordings that are written down, and motion that is none."""

import tracemalloc

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.outliers import outliers
from catseye.calibration.resolution.recording import recording_of
from catseye.calibration.resolution.steps import steps
from tests.unit.calibration.resolution.staircase import DEG, STEPS_DEG, Bench

COMMAND = STEPS_DEG[:60] * DEG


@pytest.mark.parametrize("rate_hz", [25.0, 100.0, 1000.0])
@pytest.mark.parametrize("noise", [0.0, 1e-6 * DEG, 1e-4 * DEG])
def test_motion_and_noise_have_no_outliers(rate_hz: float, noise: float) -> None:
    bench = Bench(rate_hz=rate_hz, motion_s=0.2, noise=noise)
    _, position = bench.samples(bench.moves(COMMAND), COMMAND)
    assert not outliers(position, 0.0, rate_hz).any()


@pytest.mark.parametrize("rate_hz", [50.0, 200.0, 1000.0])
def test_a_ringing_step_has_no_outliers(rate_hz: float) -> None:
    bench = Bench(rate_hz=rate_hz, motion_s=0.04, noise=1e-7 * DEG)
    moves = bench.moves(COMMAND)
    time_s, position = bench.samples(moves, COMMAND)
    for at_s, size in zip(moves.time_s, COMMAND, strict=True):
        since_s = np.maximum(time_s - at_s - bench.motion_s, 0.0)
        position += 0.3 * size * np.exp(-8.0 * since_s) * np.sin(60.0 * since_s)
    assert not outliers(position, 0.0, rate_hz).any()


def test_counts_that_flicker_are_no_outliers() -> None:
    counts: Floats = np.round(np.random.default_rng(1).normal(0.0, 0.4, 20_000))
    assert not outliers(counts, 1.0, 25.0).any()


@pytest.mark.parametrize("at_s", [20.0, 61.9, 62.4, 65.5, 200.0])
@pytest.mark.parametrize(
    ("rate_hz", "count"), [(100.0, 1), (100.0, 3), (100.0, 5), (1000.0, 1), (1000.0, 40)]
)
def test_glitches_leave_the_steps_as_they_are(at_s: float, rate_hz: float, count: int) -> None:
    bench = Bench(rate_hz=rate_hz, noise=1e-5 * DEG)
    moves = bench.moves(COMMAND)
    time_s, position = bench.samples(moves, COMMAND)
    whole = steps(recording_of(time_s, position, "rad"), moves)
    first = int(np.searchsorted(time_s, at_s))
    position[first : first + count] += 9.6 * DEG
    found = recording_of(time_s, position, "rad")
    (flag,) = found.flags
    assert flag.kind == "outlier"
    assert flag.text.startswith(f"{count} of {time_s.size} samples lie far off those around them")
    assert f"sample {first + 1} at {time_s[first]:.2f} s, by 9." in flag.text
    again = steps(found, moves)
    assert again.measured == pytest.approx(whole.measured, abs=whole.noise.step)
    assert again.noise.step == pytest.approx(whole.noise.step, rel=0.1)
    assert again.judged.tolist() == whole.judged.tolist()


@pytest.mark.parametrize("count", [1, 400])
def test_glitches_at_50_khz_take_little_memory(count: int) -> None:
    """The fastest capture of an XL-80; each glitch lies within 0.05 s of 5000 samples."""
    bench = Bench(rate_hz=50_000.0, lead_s=2.0, dwell_s=2.0, noise=1e-5 * DEG)
    _, position = bench.samples(bench.moves(COMMAND[:4]), COMMAND[:4])
    at = np.linspace(1000, position.size - 9000, 10).astype(int)
    glitches = (at[:, None] + np.arange(count)).ravel()
    position[glitches] += 9.6 * DEG
    tracemalloc.start()
    off = outliers(position, 0.0, bench.rate_hz)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert np.flatnonzero(off).tolist() == glitches.tolist()
    assert off[glitches] == pytest.approx(9.6 * DEG, rel=0.01)
    # Differences, their sizes and the sorting of them are some recordings long, the neighbours are not.
    assert peak < 10 * position.nbytes + 100e6


@pytest.mark.parametrize("sample", [0, 1, -2, -1])
def test_a_glitch_at_an_end_is_found(sample: int) -> None:
    bench = Bench(rate_hz=100.0, motion_s=0.2, noise=1e-6 * DEG)
    _, position = bench.samples(bench.moves(COMMAND), COMMAND)
    position[sample] += 0.1
    assert np.flatnonzero(outliers(position, 0.0, 100.0)).tolist() == [sample % position.size]
