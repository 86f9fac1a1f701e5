"""Numbers as a reader wants them: rounded to what is known, with a true minus sign."""

import math
import re
from collections.abc import Iterable

NOTHING = "–"
"""Stands where there is no value."""


def fixed(value: float | None, decimals: int) -> str:
    """Return a number with so many decimals; a dash for None and NaN."""
    if value is None or not math.isfinite(value):
        return NOTHING
    text = f"{value:.{decimals}f}"
    if float(text) == 0.0:
        text = text.lstrip("-")
    return text.replace("-", "−")


def signed(value: float | None, decimals: int) -> str:
    """Return a number that shows its sign."""
    text = fixed(value, decimals)
    return text if value is None or text == NOTHING or value <= 0.0 else f"+{text}"


def decimals_for(uncertainties: Iterable[float], fallback: int = 4) -> int:
    """Return the decimals that show the smallest uncertainty with two digits, at most 6."""
    known = [u for u in uncertainties if math.isfinite(u) and u > 0.0]
    if not known:
        return fallback
    return min(6, max(0, 1 - math.floor(math.log10(min(known)))))


def plain(value: float) -> str:
    """Return a number as short as it can be written."""
    return f"{value:g}".replace("-", "−")


def counted(count: int, noun: str) -> str:
    """Return how many there are of something."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def unbroken(text: str) -> str:
    """Return a text in which no line ends between a number and its unit."""
    return re.sub(r"(?<=\d) (?=(?:µm|mm|mdeg|%|u)\b|%)", "\u00a0", text)


def three_digits(value: float) -> str:
    """Return a number with three significant digits and no exponent."""
    if value == 0.0 or not math.isfinite(value):
        return fixed(value, 0)
    return fixed(value, max(0, 2 - math.floor(math.log10(abs(value)))))


def probability(p: float) -> str:
    """Return a probability as an equation: p = 0.31, p < 0.001."""
    return "p < 0.001" if p < 0.001 else f"p = {p:.{3 if p < 0.1 else 2}f}"


def duration(seconds: float | None) -> str:
    """Return a time as h min s."""
    if seconds is None:
        return NOTHING
    whole = round(seconds)
    hours, minutes = divmod(whole // 60, 60)
    if hours:
        return f"{hours} h {minutes:02d} min"
    return f"{minutes} min {whole % 60:02d} s" if minutes else f"{seconds:.1f} s"
