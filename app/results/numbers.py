"""Numbers, durations and counts as a reader wants them; the only place that formats them."""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Final, Literal

from catseye.procedures.kit.expanded import EXPANDED as EXPANDED

CONVENTION_OF_U: Final = "U is the expanded uncertainty (k = 2); files hold the standard uncertainty u."
"""Said once where uncertainties are shown."""

NOTHING: Final = "–"
"""Stands where there is no value."""

BLANK: Final = "………………………………………"
"""Stands where somebody writes by hand."""

MINUS: Final = "−"

SHARE_EXPECTED: Final = 0.9
"""Fewer than this share of errors within the expanded uncertainty speaks against the stated uncertainties."""

MDEG_PER_RAD: Final = 1e3 * math.degrees(1.0)

_SMALL: Final = 1e-6
"""Below this nobody counts zeros: significant digits stand before an exponent."""

Style = Literal["text", "fixed", "significant", "plain", "percent", "probability", "duration"]


@dataclass(frozen=True)
class Format:
    """How a number is written.

    Attributes:
        style: fixed decimals, significant digits, as short as possible, …; text leaves the cell as it is.
        digits: decimals of "fixed" and "percent", digits of "significant".
        signed: a plus sign stands before positive numbers.
    """

    style: Style
    digits: int = 0
    signed: bool = False


TEXT: Final = Format("text")
COUNT: Final = Format("fixed", 0)
PLAIN: Final = Format("plain")
PERCENT: Final = Format("percent", 0)
PROBABILITY: Final = Format("probability")
DURATION: Final = Format("duration")
THREE_DIGITS: Final = Format("significant", 3)


def fixed(decimals: int, *, signed: bool = False) -> Format:
    """Return a format with so many decimals."""
    return Format("fixed", decimals, signed)


OF_UNIT: Final = {"mm": fixed(4), "mdeg": fixed(2), "µm": fixed(2)}
"""Formats of a result's values by their unit."""


def number(value: float | None, form: Format, minus: str = MINUS) -> str:
    """Return a number as text; a dash for None and for what is not finite.

    Args:
        minus: sign of negative numbers; "-" where a program may read them.
    """
    if value is None or not math.isfinite(value):
        return NOTHING
    text = _STYLES[form.style](value, form.digits)
    if text.startswith("-") and not text.strip("-0."):
        text = text[1:]
    if form.signed and value > 0.0:
        text = f"+{text}"
    return text.replace("-", minus)


def duration_text(seconds: float, *, whole: bool = False) -> str:
    """Return a duration: 4.2 s, 42 s, 3 min 05 s, 2 h 07 min.

    Args:
        seconds: not negative.
        whole: no tenths below 10 s, for what is redrawn all the time.
    """
    if seconds < 9.95 and not whole:
        return f"{seconds:.1f} s"
    rounded = max(0, round(seconds))
    if rounded < 60:
        return f"{rounded} s"
    minutes, rest = divmod(rounded, 60)
    if minutes < 60:
        return f"{minutes} min {rest:02d} s"
    return f"{minutes // 60} h {minutes % 60:02d} min"


def utc_text(time_utc: str) -> str:
    """Return a moment as a reader wants it: 2026-11-27 06:50:03 UTC; what is no time stays as it is.

    Args:
        time_utc: ISO 8601.
    """
    try:
        moment = datetime.fromisoformat(time_utc)
    except ValueError:
        return time_utc
    in_utc = moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment.astimezone(UTC)
    return f"{in_utc:%Y-%m-%d %H:%M:%S} UTC"


def age_text(age_s: float) -> str:
    """Return an age: just now, 12 min ago, 5 h ago, 3 d ago."""
    if age_s < 90.0:
        return "just now"
    minutes = age_s / 60.0
    if minutes < 90.0:
        return f"{minutes:.0f} min ago"
    hours = minutes / 60.0
    return f"{hours:.0f} h ago" if hours < 36.0 else f"{hours / 24.0:.0f} d ago"


def clock_text(seconds: float | None) -> str:
    """Return a duration as h:min:s for a narrow column; empty for None."""
    if seconds is None:
        return ""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes // 60}:{minutes % 60:02d}:{rest:02d}"


def probability_text(p: float) -> str:
    """Return a probability as an equation: p = 0.31, p < 0.001."""
    return f"p {_probability(p)}" if p < 0.001 else f"p = {_probability(p)}"


def decimals_for(uncertainties: Iterable[float], fallback: int = 4) -> int:
    """Return the decimals that show the smallest uncertainty with two digits, at most 6."""
    known = [u for u in uncertainties if math.isfinite(u) and u > 0.0]
    return min(6, max(0, 1 - math.floor(math.log10(min(known))))) if known else fallback


def counted(count: int, noun: str) -> str:
    """Return how many there are of something."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def listed(names: Iterable[str], most: int = 4) -> str:
    """Return names, the first of a long list only."""
    known = list(names)
    more = f" and {len(known) - most} more" if len(known) > most else ""
    return ", ".join(known[:most]) + more


def _significant(value: float, digits: int) -> str:
    if value == 0.0:
        return "0"
    if abs(value) < _SMALL:
        mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
        return f"{mantissa}e{int(exponent)}"
    return f"{value:.{max(0, digits - 1 - math.floor(math.log10(abs(value))))}f}"


def _probability(p: float) -> str:
    return "< 0.001" if p < 0.001 else f"{p:.{3 if p < 0.1 else 2}f}"


_STYLES: Final[Mapping[Style, Callable[[float, int], str]]] = {
    "text": lambda value, _: str(value),
    "fixed": lambda value, digits: f"{value:.{digits}f}",
    "significant": _significant,
    "plain": lambda value, _: f"{value:g}",
    "percent": lambda value, digits: f"{100.0 * value:.{digits}f} %",
    "probability": lambda p, _: _probability(p),
    "duration": lambda value, _: duration_text(value),
}
