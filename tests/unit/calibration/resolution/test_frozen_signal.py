"""Signals that stand still: saturated, without a beam, or merely at rest."""

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import RecordingError
from catseye.calibration.resolution.frozen_signal import FrozenStretch, frozen_stretch, require_unsaturated
from catseye.calibration.resolution.moves import Moves, moves_of
from catseye.calibration.resolution.recording import recording_of
from catseye.calibration.resolution.steps import steps
from tests.unit.calibration.resolution.staircase import STEPS_DEG, Bench

TIME_S = np.arange(0.0, 10.0, 0.001)
MOVES = moves_of(0.5 + np.arange(10.0), np.full(10, 1e-3), "rad")


def noisy(time_s: Floats) -> Floats:
    return np.random.default_rng(1).normal(0.0, 1e-6, time_s.size)


def found_in(time_s: Floats, position: Floats, moves: Moves = MOVES) -> FrozenStretch | None:
    return frozen_stretch(recording_of(time_s, position, "rad"), moves)


def test_a_saturated_signal_is_flagged_with_its_times() -> None:
    position = np.minimum(0.001 * TIME_S, 0.0095) + noisy(TIME_S)
    position[TIME_S >= 9.5] = position.max()
    found = found_in(TIME_S, position)
    assert found is not None
    assert "from 9.50 s to 10.00 s" in found.text
    assert "at the end of its range: it is saturated" in found.text


def test_a_lost_beam_is_flagged_in_mid_range() -> None:
    position = noisy(TIME_S)
    position[3000:3400] = 0.0
    found = found_in(TIME_S, position)
    assert found is not None
    assert "samples 3001 to 3400" in found.text
    assert "in mid-range" in found.text


def saturated(share: float) -> Floats:
    position = 0.001 * TIME_S + noisy(TIME_S)
    first = round((1.0 - share) * TIME_S.size)
    position[first:] = position.max()
    return position


@pytest.mark.parametrize("share", [0.3, 0.5])
def test_a_saturated_end_is_refused_at_its_sample(share: float) -> None:
    found = found_in(TIME_S, saturated(share))
    with pytest.raises(RecordingError, match="at the end of its range: it is saturated") as refused:
        require_unsaturated(found)
    assert refused.value.row == round((1.0 - share) * TIME_S.size) + 1


def test_a_short_saturation_is_not_refused() -> None:
    found = found_in(TIME_S, saturated(0.1))
    assert found is not None
    require_unsaturated(found)


def _times_at_25_hz(count: int) -> Floats:
    times_s: Floats = 0.04 * np.arange(count, dtype=np.float64)
    return times_s


@pytest.mark.parametrize("noise", [0.3, 0.5, 1.0, 3.0])
def test_a_quantised_counter_at_rest_is_not_frozen(noise: float) -> None:
    # 1500 s at 25 Hz; the noise in counts, and the same smoothed over three samples.
    for seed in range(20):
        white = np.random.default_rng(seed).normal(0.0, noise, 37_500)
        time_s = _times_at_25_hz(white.size)
        assert found_in(time_s, np.floor(white)) is None
        assert found_in(time_s, np.floor(np.convolve(white, np.ones(3), "same"))) is None


def test_a_quantised_counter_that_stands_is_frozen() -> None:
    counts: Floats = np.floor(np.random.default_rng(1).normal(0.0, 0.5, 37_500))
    counts[20_000:20_100] = 0.0
    moves = moves_of(1.5 + 2.0 * np.arange(700.0), np.full(700, 10.0), "rad")
    found = found_in(_times_at_25_hz(counts.size), counts, moves)
    assert found is not None
    assert found.start_s <= 800.0
    assert found.end_s >= 803.96


def test_a_coarse_signal_is_not_taken_for_a_frozen_one() -> None:
    coarse = np.round(TIME_S + 1e3 * noisy(TIME_S), 0)
    assert found_in(TIME_S, coarse) is None


def test_equal_readings_of_few_digits_are_no_frozen_signal() -> None:
    # A reading of a counter with 2 nm noise and 1 nm digits, 25 a second: five equal ones in a row are common.
    rng, time_s = np.random.default_rng(5), np.arange(15000) / 25.0
    coarse = np.round(rng.normal(0.0, 2.0, (40, time_s.size)))
    flagged = [one for one in coarse if found_in(time_s, one * 1e-6)]
    assert len(flagged) <= 1


@pytest.mark.parametrize(
    ("rate_hz", "digit", "noise"), [(25.0, 10.0, 1.0), (25.0, 10.0, 1.5), (25.0, 79.0, 10.0)]
)
def test_a_coarse_counter_at_rest_is_neither_refused_nor_flagged(
    rate_hz: float, digit: float, noise: float
) -> None:
    # Digit and noise in nm, on optics of 30 mm: the standstill is the least value of a test in one direction.
    nm = 1e-6 / 30.0
    bench = Bench(rate_hz=rate_hz, motion_s=0.3, noise=noise * nm)
    moves = bench.moves(np.radians(STEPS_DEG))
    for seed in range(8):
        time_s, position = bench.samples(moves, moves.command, seed)
        found = steps(recording_of(time_s, np.round(position / (digit * nm)) * digit * nm, "rad"), moves)
        assert not [flag for flag in found.flags if flag.kind == "frozen-signal"]


def test_a_coarse_counter_that_stands_through_moves_is_flagged() -> None:
    bench = Bench(rate_hz=25.0, motion_s=0.3, noise=0.2)
    moves = bench.moves(np.full(60, 100.0))
    time_s, position = bench.samples(moves, moves.command)
    counts: Floats = np.floor(position + 0.3)
    counts[time_s > 200.0] = counts[time_s > 200.0][0]
    found = found_in(time_s, counts, moves)
    assert found is not None
    assert found.over_moves
    assert "or the joint did not follow its commands" in found.text
    require_unsaturated(found)


def test_a_saturated_signal_is_refused_beside_a_longer_rest() -> None:
    bench = Bench(noise=1e-6)
    moves = bench.moves(np.full(40, 1e-3))
    time_s, position = bench.samples(moves, moves.command)
    position[(time_s > 35.0) & (time_s < 58.0)] = 0.0
    position[time_s > 248.0] = 0.05
    with pytest.raises(RecordingError, match=r"from 248\.01 s .* at the end of its range"):
        steps(recording_of(time_s, position, "rad"), moves)
