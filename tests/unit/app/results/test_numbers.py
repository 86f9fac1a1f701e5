"""Numbers, durations and counts as a reader wants them."""

import math

import pytest

from catseye.app.results.numbers import (
    COUNT,
    NOTHING,
    PERCENT,
    PLAIN,
    PROBABILITY,
    THREE_DIGITS,
    Format,
    age_text,
    clock_text,
    counted,
    decimals_for,
    duration_text,
    fixed,
    listed,
    number,
    probability_text,
    utc_text,
)

SIGNED = fixed(1, signed=True)


@pytest.mark.parametrize(
    ("value", "form", "text"),
    [
        (-1.005, fixed(1), "−1.0"),
        (-0.0001, fixed(2), "0.00"),
        (None, fixed(2), NOTHING),
        (math.nan, fixed(2), NOTHING),
        (math.inf, fixed(2), NOTHING),
        (12, COUNT, "12"),
        (0.0000123, THREE_DIGITS, "0.0000123"),
        (3.594e-8, THREE_DIGITS, "3.59e−8"),
        (-9.999e-7, THREE_DIGITS, "−1.00e−6"),
        (1.0, SIGNED, "+1.0"),
        (-1.0, SIGNED, "−1.0"),
        (0.0, SIGNED, "0.0"),
        (None, SIGNED, NOTHING),
        (-40.0, PLAIN, "−40"),
        (17.82, THREE_DIGITS, "17.8"),
        (0.8034, THREE_DIGITS, "0.803"),
        (1234.5, THREE_DIGITS, "1234"),
        (0.0, THREE_DIGITS, "0"),
        (0.954, PERCENT, "95 %"),
        (1e-9, PROBABILITY, "< 0.001"),
        (0.0123, PROBABILITY, "0.012"),
    ],
)
def test_number_follows_its_format(value: float | None, form: Format, text: str) -> None:
    assert number(value, form) == text


def test_a_program_reads_the_ascii_minus() -> None:
    assert float(number(-1.25, fixed(2), minus="-")) == -1.25


@pytest.mark.parametrize(
    ("seconds", "whole", "text"),
    [
        (2.34, False, "2.3 s"),
        (9.97, False, "10 s"),
        (183.2, False, "3 min 03 s"),
        (5025.0, False, "1 h 23 min"),
        (-3.0, True, "0 s"),
        (0.4, True, "0 s"),
        (59.4, True, "59 s"),
        (59.6, True, "1 min 00 s"),
        (61.0, True, "1 min 01 s"),
        (3599.7, True, "1 h 00 min"),
        (3661.0, True, "1 h 01 min"),
        (90_000.0, True, "25 h 00 min"),
    ],
)
def test_durations_read_plainly(seconds: float, whole: bool, text: str) -> None:
    assert duration_text(seconds, whole=whole) == text


@pytest.mark.parametrize(
    ("age_s", "text"),
    [(5.0, "just now"), (720.0, "12 min ago"), (5 * 3600.0, "5 h ago"), (3 * 86400.0, "3 d ago")],
)
def test_ages_read_plainly(age_s: float, text: str) -> None:
    assert age_text(age_s) == text


def test_clock_time_of_a_column() -> None:
    assert clock_text(3671.4) == "1:01:11"
    assert clock_text(None) == ""


def test_probability_is_an_equation() -> None:
    assert [probability_text(p) for p in (1e-9, 0.0123, 0.3)] == ["p < 0.001", "p = 0.012", "p = 0.30"]


def test_counts_have_their_plural() -> None:
    assert (counted(1, "segment"), counted(2, "segment")) == ("1 segment", "2 segments")


def test_long_lists_are_cut() -> None:
    assert listed("abcdef") == "a, b, c, d and 2 more"
    assert listed("ab") == "a, b"


@pytest.mark.parametrize(
    ("uncertainties", "decimals"),
    [([0.0023, 0.01], 4), ([1.5], 1), ([15.0], 0), ([1e-12], 6), ([0.0, math.nan], 4)],
)
def test_uncertainty_shows_two_digits(uncertainties: list[float], decimals: int) -> None:
    assert decimals_for(uncertainties) == decimals


@pytest.mark.parametrize(
    ("moment", "text"),
    [
        ("2026-11-27T06:50:03.390560+00:00", "2026-11-27 06:50:03 UTC"),
        ("2026-11-27T06:50:03Z", "2026-11-27 06:50:03 UTC"),
        ("2026-11-27T08:50:03+02:00", "2026-11-27 06:50:03 UTC"),
        ("2026-11-27T06:50:03", "2026-11-27 06:50:03 UTC"),
        ("some day", "some day"),
    ],
)
def test_moments_are_written_in_utc(moment: str, text: str) -> None:
    assert utc_text(moment) == text
