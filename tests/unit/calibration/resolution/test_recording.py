"""Recordings: what is noticed, what is refused, and where."""

from collections.abc import Callable

import numpy as np
import pytest

from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import RecordingError
from catseye.calibration.resolution.recording import recording_of
from catseye.calibration.resolution.sampling import (
    LEAST_RATE_HZ,
    NEARLY,
    require_stated_rate,
    require_steady_rate,
)

TIME_S = np.arange(0.0, 10.0, 0.001)


def noisy(time_s: Floats) -> Floats:
    return np.random.default_rng(1).normal(0.0, 1e-6, time_s.size)


def test_rate_and_times_are_found() -> None:
    found = recording_of(3.0 + TIME_S, noisy(TIME_S), "rad")
    assert found.rate_hz == pytest.approx(1000.0)
    assert (found.start_s, found.flags) == (3.0, ())
    assert found.time_s() == pytest.approx(3.0 + TIME_S)
    assert found.end_s == pytest.approx(12.999)


def test_a_part_has_the_samples_of_its_times() -> None:
    found = recording_of(TIME_S, TIME_S, "mm")
    assert found.between(2.0, 2.003) == pytest.approx([2.0, 2.001, 2.002])
    part = found.clipped(5.0, 6.0)
    assert (part.start_s, part.position.size) == (5.0, 1000)


@pytest.mark.parametrize(
    ("change", "row", "text"),
    [
        (lambda t, p: (p, t), 2, "does not follow.*columns are swapped"),
        (
            lambda t, p: (np.append(t, t[-1] + 20.0), np.append(p, 0.0)),
            10001,
            "20 s lie between .*two recordings",
        ),
        (lambda t, p: (0.0 * t, p), 2, "does not follow"),
        (lambda t, p: (np.append(t, t), np.append(p, p)), 10001, "two recordings stand in one file"),
        (lambda t, p: (t, np.where(t == TIME_S[41], np.nan, p)), 42, "sample 42 has no position"),
        (lambda t, p: (np.where(t == TIME_S[7], np.inf, t), p), 8, "sample 8 has no time"),
    ],
)
def test_damaged_recordings_are_refused_at_their_row(
    change: Callable[[Floats, Floats], tuple[Floats, Floats]], row: int, text: str
) -> None:
    with pytest.raises(RecordingError, match=text) as refused:
        recording_of(*change(TIME_S, noisy(TIME_S)[::-1].copy()), "rad")
    assert refused.value.row == row


@pytest.mark.parametrize(("factor", "rate"), [(1e3, "1 samples"), (100.0, "10 samples"), (1e-4, "1e\\+07")])
def test_rates_that_no_recording_has_are_refused(factor: float, rate: str) -> None:
    with pytest.raises(RecordingError, match=rf"{rate}.*unit of the time column"):
        recording_of(TIME_S * factor, noisy(TIME_S), "rad")


@pytest.mark.parametrize("rate_hz", [20.0 / 1.0001, 19.5])
def test_what_a_run_takes_for_fast_enough_is_evaluated(rate_hz: float) -> None:
    assert rate_hz > NEARLY * LEAST_RATE_HZ
    time_s = np.arange(0.0, 60.0, 1.0 / rate_hz)
    assert recording_of(time_s, noisy(time_s), "rad").rate_hz == pytest.approx(rate_hz)


def test_a_rate_that_changes_is_refused() -> None:
    slower = np.where(TIME_S < 5.0, TIME_S, 5.0 + (TIME_S - 5.0) * 1.2)
    with pytest.raises(RecordingError, match="the rate is not uniform") as refused:
        require_steady_rate(slower)
    assert refused.value.row == 5001


def test_jitter_and_gaps_are_a_steady_rate() -> None:
    shaken = TIME_S + np.random.default_rng(2).uniform(-4e-4, 4e-4, TIME_S.size)
    kept_s = np.delete(shaken, slice(3000, 3600))
    require_steady_rate(kept_s)
    found = recording_of(kept_s, 3.0 * kept_s, "mm")
    # The median of such intervals is known to half a per cent; values keep their times all the same.
    assert found.rate_hz == pytest.approx(1000.0, rel=5e-3)
    assert found.missing is not None
    known = ~found.missing
    assert found.position[known] == pytest.approx(3.0 * found.time_s()[known], abs=3e-3)
    assert {flag.kind for flag in found.flags} == {"gap", "irregular-sampling"}
    # A fifth more between the samples of one half is neither.
    with pytest.raises(RecordingError, match="the rate is not uniform"):
        require_steady_rate(shaken + 0.2 * np.maximum(shaken - 5.0, 0.0))


def test_a_rate_that_contradicts_the_times_is_named() -> None:
    require_stated_rate(TIME_S, 1000.4)
    with pytest.raises(RecordingError, match="give 1000 samples a second, 500 Hz are stated"):
        require_stated_rate(TIME_S, 500.0)


def test_lost_samples_leave_the_others_in_place() -> None:
    time_s, position = np.delete(TIME_S, slice(500, 503)), np.delete(TIME_S**2, slice(500, 503))
    found = recording_of(time_s, position, "mm")
    assert found.missing is not None
    assert np.flatnonzero(found.missing).tolist() == [500, 501, 502]
    assert found.position[~found.missing] == pytest.approx(position)
    assert found.between(0.499, 0.505) == pytest.approx([0.499**2, 0.503**2, 0.504**2])
    assert found.end_s == pytest.approx(TIME_S[-1])
    (flag,) = found.flags
    assert (flag.kind, flag.text[:21]) == ("gap", "3 samples are missing")
    assert "lasts 0.004 s, from 0.50 s on (behind sample 500)" in flag.text


def test_a_late_sample_costs_only_itself() -> None:
    late_s = np.where(TIME_S[700] == TIME_S, TIME_S + 6e-4, TIME_S)
    found = recording_of(late_s, 3.0 * late_s, "mm")
    assert found.position == pytest.approx(3.0 * TIME_S, abs=1e-9)
    assert found.missing is not None
    assert np.flatnonzero(found.missing).tolist() == [700]


def test_a_wandering_rate_keeps_values_at_their_times() -> None:
    time_s = np.cumsum(1e-3 * (1.0 + 0.05 * np.sin(TIME_S)))
    found = recording_of(time_s, 3.0 * time_s, "mm")
    assert found.position == pytest.approx(3.0 * found.time_s(), abs=1e-9)
    assert found.missing is not None
    assert not found.missing.any()
    assert [flag.kind for flag in found.flags] == ["irregular-sampling"]


def test_jitter_is_flagged() -> None:
    shaken = TIME_S + np.random.default_rng(2).uniform(-2e-4, 2e-4, TIME_S.size)
    (flag,) = recording_of(shaken, noisy(TIME_S), "rad").flags
    assert flag.kind == "irregular-sampling"
    assert "12 %" in flag.text


def test_an_empty_recording_is_refused() -> None:
    with pytest.raises(RecordingError, match="fewer than two samples"):
        recording_of(np.zeros(1), np.zeros(1), "rad")


def test_columns_of_different_length_are_refused() -> None:
    with pytest.raises(ArgumentError, match="position"):
        recording_of(TIME_S, np.zeros(5), "rad")
