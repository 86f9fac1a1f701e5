"""Clocks whose offset and drift are written down."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.alignment import ClockAlignment, align
from catseye.calibration.resolution.errors import ClockError
from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.steps import steps
from tests.unit.calibration.resolution.staircase import DEG, STEPS_DEG, Bench

BENCH = Bench(rate_hz=50.0, noise=1e-5 * DEG)
COMMAND = STEPS_DEG[:60] * DEG
EQUAL = np.repeat([1.0, -1.0, 1.0], 10) * 2e-3 * DEG


def other_clock(moves: Moves, offset_s: float, drift: float) -> Moves:
    """Return the moves by a clock that is behind by the offset in the middle of the test."""
    about_s = float(moves.time_s.mean())
    return replace(moves, time_s=about_s - offset_s + (moves.time_s - about_s) / (1.0 + drift))


def aligned(command: Floats, offset_s: float, drift: float = 0.0, seed: int = 1) -> ClockAlignment:
    moves = BENCH.moves(command)
    return align(BENCH.recorded(moves, command, seed), other_clock(moves, offset_s, drift))


@pytest.mark.parametrize("offset_s", [-13.3, 0.0, 41.7])
@pytest.mark.parametrize("command", [COMMAND, EQUAL])
def test_the_offset_is_found_to_a_fraction_of_the_motion(command: Floats, offset_s: float) -> None:
    found = aligned(command, offset_s)
    # Motions begin with their commands.
    assert found.offset_s == pytest.approx(offset_s, abs=2.0 * found.u_offset_s)
    assert found.u_offset_s < 0.2
    assert found.peaks >= 20


def test_drift_is_found_within_its_uncertainty() -> None:
    many = [aligned(COMMAND, 5.0, 3e-4, seed) for seed in range(10)]
    assert np.array([one.drift for one in many]) == pytest.approx(3e-4, abs=1e-4)
    assert np.sqrt(np.mean([((one.drift - 3e-4) / one.u_drift) ** 2 for one in many])) < 1.7


def test_aligned_moves_lie_at_the_begin_of_the_motion() -> None:
    moves = BENCH.moves(COMMAND)
    given = other_clock(moves, 41.7, 1e-4)
    found = align(BENCH.recorded(moves, COMMAND), given)
    assert found.moves(given).time_s == pytest.approx(moves.time_s, abs=0.1)
    assert found.times_s(given.time_s) == pytest.approx(found.moves(given).time_s)


@pytest.mark.parametrize("drift_per_s", [0.0, 1e-5 * DEG])
@pytest.mark.parametrize("motion_s", [0.2, 0.3, 0.6, 1.0, 1.5, 2.0, 2.5])
def test_aligned_steps_are_those_of_one_clock(motion_s: float, drift_per_s: float) -> None:
    bench = replace(BENCH, noise=1e-6 * DEG, motion_s=motion_s, drift_per_s=drift_per_s)
    moves = bench.moves(COMMAND)
    recording, given = bench.recorded(moves, COMMAND), other_clock(moves, 7.3, 1e-5)
    expected, found = (steps(recording, one) for one in (moves, align(recording, given).moves(given)))
    assert {flag.kind for flag in found.flags} == {flag.kind for flag in expected.flags}
    assert found.noise.drift_per_s == pytest.approx(expected.noise.drift_per_s, rel=0.01)
    assert np.abs(found.measured - expected.measured).max() < 3.0 * expected.noise.step


@pytest.mark.parametrize("motion_s", [0.05, 0.1, 0.2, 0.3])
def test_quick_steps_with_scatter_are_aligned(motion_s: float) -> None:
    bench = replace(BENCH, noise=1e-7, motion_s=motion_s)
    moves = bench.moves(STEPS_DEG * DEG)
    for seed in range(8):
        done = moves.command * (1.0 + np.random.default_rng(seed).normal(0.0, 0.02, len(moves)))
        found = align(bench.recorded(moves, done, seed), other_clock(moves, 17.3, 0.0))
        assert found.offset_s == pytest.approx(17.3, abs=2.0 * found.u_offset_s)


@pytest.mark.parametrize("motion_s", [0.05, 0.2, 0.8, 2.0])
@pytest.mark.parametrize("scatter", [0.0, 0.1])
def test_an_offset_ambiguous_by_a_dwell_is_refused(motion_s: float, scatter: float) -> None:
    bench = replace(BENCH, motion_s=motion_s)
    moves = bench.moves(np.full(13, 2e-3 * DEG))
    done = moves.command * (1.0 + np.random.default_rng(1).normal(0.0, scatter, len(moves)))
    recording = bench.recorded(moves, done)
    fewer = Moves(moves.time_s[:12], moves.command[:12], "rad")
    with pytest.raises(ClockError, match="1 dwell away: the offset is ambiguous"):
        align(recording, fewer)


def test_moves_of_another_test_are_refused() -> None:
    moves = BENCH.moves(COMMAND)
    with pytest.raises(ClockError, match="at no offset"):
        align(BENCH.recorded(moves, COMMAND), replace(moves, command=-moves.command))


def test_a_recording_shorter_than_the_moves_is_refused() -> None:
    moves = BENCH.moves(COMMAND)
    with pytest.raises(ClockError, match="does not cover them"):
        align(BENCH.recorded(moves, COMMAND).clipped(0.0, 200.0), moves)


def test_steps_in_the_noise_are_refused() -> None:
    bench = replace(BENCH, noise=5e-3 * DEG)
    moves = bench.moves(STEPS_DEG[30:60] * DEG)
    with pytest.raises(ClockError, match="stand out of the noise"):
        align(bench.recorded(moves, moves.command), moves)


def test_motions_that_take_most_of_a_dwell_are_refused() -> None:
    bench = replace(BENCH, motion_s=4.4)
    moves = bench.moves(COMMAND)
    with pytest.raises(ClockError):
        align(bench.recorded(moves, COMMAND), moves)
