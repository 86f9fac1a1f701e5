"""When a job has to be over: a time of day, an instant, or a duration from its start."""

import re
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta, tzinfo
from itertools import product
from typing import Final

from catseye.app.errors import UsageError

_EXAMPLE: Final = "give a time of day 06:30, a time 2026-03-01T06:30+01:00, or a duration 8h or 90min"
_DURATION: Final = re.compile(r"(?P<number>\d+(?:\.\d+)?)\s*(?P<unit>h|min|s)")
_TIME_OF_DAY: Final = re.compile(r"(?P<hour>\d{1,2}):(?P<minute>\d{2})")
_UNIT_S: Final = {"h": 3600.0, "min": 60.0, "s": 1.0}


@dataclass(frozen=True)
class Deadline:
    """When a job has to be over.

    Attributes:
        time: UTC, by the clock on the wall.
        within_s: of a duration: real s from its being given, whatever becomes of that clock; None of a time.
    """

    time: datetime
    within_s: float | None = None

    @property
    def text(self) -> str:
        """As ISO 8601."""
        return self.time.isoformat(timespec="seconds")


def require_deadline(text: str, where: str) -> None:
    """Check that a text is a deadline, or empty.

    Raises:
        UsageError: it is none.
    """
    if text:
        deadline_of(text, datetime.now(UTC), where=where)


def deadline_of(text: str, now: datetime, zone: tzinfo | None = None, where: str = "--deadline") -> Deadline:
    """Return when a job has to be over.

    Args:
        text: a time of day (the next one), an ISO 8601 time, or a duration from now.
        now: UTC time.
        zone: of a text that names none; None for that of this computer.
        where: the text stands, for the error.

    Raises:
        UsageError: the text is no deadline, or it has passed.
    """
    try:
        return _deadline_of(text.strip(), now, zone, f"{where} {text!r}")
    except OverflowError:
        raise UsageError(f"{where} {text!r} lies too far away: {_EXAMPLE}") from None


def _deadline_of(text: str, now: datetime, zone: tzinfo | None, what: str) -> Deadline:
    if duration := _DURATION.fullmatch(text):
        within_s = float(duration["number"]) * _UNIT_S[duration["unit"]]
        return Deadline(now + timedelta(seconds=within_s), within_s)
    if time := _TIME_OF_DAY.fullmatch(text):
        return Deadline(_next(time, now.astimezone(zone), zone, what))
    try:
        found = datetime.fromisoformat(text)
    except ValueError:
        raise UsageError(f"{what} is no time: {_EXAMPLE}") from None
    found = (found if found.tzinfo else found.replace(tzinfo=zone)).astimezone(UTC)
    if found <= now:
        raise UsageError(f"{what} has passed: {_EXAMPLE}")
    return Deadline(found)


def _next(time: re.Match[str], local: datetime, zone: tzinfo | None, what: str) -> datetime:
    """Return when the clock on the wall shows a time of day next."""
    hour, minute = int(time["hour"]), int(time["minute"])
    if hour > 23 or minute > 59:
        raise UsageError(f"{what} is no time of day: {_EXAMPLE}")
    # Wall time without a zone: the night in which the clocks change has 23 or 25 hours.
    wall = local.replace(tzinfo=None, hour=hour, minute=minute, second=0, microsecond=0)
    for days, fold in product(range(2), range(2)):
        # In the night in which the clocks go back an hour comes twice.
        found = (wall + timedelta(days=days)).replace(tzinfo=zone, fold=fold).astimezone(UTC)
        if found > local:
            break
    return found
