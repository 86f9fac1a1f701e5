"""A deadline is a time of day, an instant or a duration."""

from datetime import UTC, datetime, timedelta
from zoneinfo import ZoneInfo

import pytest

from catseye.app.campaign.deadline import deadline_of
from catseye.app.errors import UsageError

BERLIN = ZoneInfo("Europe/Berlin")
NOW = datetime(2026, 3, 28, 21, 0, tzinfo=UTC)
"""22:00 in Berlin, the evening before the clocks go forward."""


def found(text: str, now: datetime = NOW) -> datetime:
    return deadline_of(text, now, BERLIN).time


def test_a_duration_counts_from_now() -> None:
    assert found("8h") == NOW + timedelta(hours=8)
    assert found("90min") == NOW + timedelta(minutes=90)
    assert found("1.5 h") == NOW + timedelta(minutes=90)


def test_a_time_of_day_is_the_next_one() -> None:
    assert found("23:30") == datetime(2026, 3, 28, 22, 30, tzinfo=UTC)
    assert found("21:30", NOW - timedelta(days=1)) == datetime(2026, 3, 28, 20, 30, tzinfo=UTC)


def test_the_night_of_changing_clocks_is_an_hour_shorter() -> None:
    assert found("06:30") == datetime(2026, 3, 29, 4, 30, tzinfo=UTC)


def test_an_hour_that_comes_twice_is_met_both_times() -> None:
    first = datetime(2026, 10, 25, 0, 30, tzinfo=UTC)
    for now, expected in (
        (first - timedelta(hours=3), first),
        (first + timedelta(minutes=10), first + timedelta(hours=1)),
        (first + timedelta(hours=2), first + timedelta(hours=25)),
    ):
        assert found("02:30", now) == expected


def test_an_instant_has_its_own_zone() -> None:
    assert found("2026-03-29T06:30+00:00") == datetime(2026, 3, 29, 6, 30, tzinfo=UTC)
    assert found("2026-03-29T06:30") == datetime(2026, 3, 29, 4, 30, tzinfo=UTC)


@pytest.mark.parametrize("text", ["soon", "25:00", "06:60", "8", "-8h", "2020-01-01T00:00+00:00"])
def test_what_is_no_time_to_come_is_refused(text: str) -> None:
    with pytest.raises(UsageError, match=r"06:30"):
        found(text)


@pytest.mark.parametrize("text", ["99999999999999h", "9999-12-31T23:59:59-12:00", "9" * 400 + "s"])
def test_what_no_clock_reaches_is_refused(text: str) -> None:
    with pytest.raises(UsageError, match="too far away"):
        found(text)
