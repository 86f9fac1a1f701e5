"""A strip chart that hides nothing: every column of dots reaches from the smallest to the largest value in it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.app.results.numbers import fixed, number
from catseye.app.tui.widgets.braille import DOTS_ACROSS, DOTS_DOWN, Canvas, Floats
from catseye.app.tui.widgets.inks import Line

TRACE: Final = "trace"
AXIS: Final = "axis"

LABEL_WIDTH: Final = 8
"""Cells left of the trace: numbers and the axis."""

_INTERVALS: Final = 3
_KEPT_SHARE: Final = 0.25
"""A scale stays as long as the values fill so much of it."""

_FINE_BELOW: Final = 1.0
_FEW: Final = 4
_MOST_BETWEEN: Final = 2.0
"""Samples that lie farther apart than so many times the usual have a gap between them."""


@dataclass(frozen=True)
class StripUnit:
    """What the numbers at the upright axis are.

    Attributes:
        name: of the values.
        fine: a thousandth of it, for numbers that lie near each other.
        finest: step below which nobody wants to see a difference.
        digits: of a range in thousandths.
    """

    name: str
    fine: str
    finest: float
    digits: int


MM: Final = StripUnit("mm", "µm", 1e-4, 1)
DEG: Final = StripUnit("deg", "mdeg", 1e-6, 3)


@dataclass(frozen=True)
class Scale:
    """The upright axis, in its unit.

    Attributes:
        low: its lower end.
        high: its upper end.
        step: between two numbers; 1, 2 or 5 times a power of ten.
        unit: of all three.
    """

    low: float
    high: float
    step: float
    unit: StripUnit = MM

    @property
    def span(self) -> float:
        """Its length."""
        return self.high - self.low

    @property
    def in_fine(self) -> bool:
        """Its numbers are thousandths of the unit from `base`."""
        return self.span < _FINE_BELOW

    @property
    def base(self) -> float:
        """What its numbers count from; zero where they are in the unit itself, or small."""
        if not self.in_fine or max(abs(self.low), abs(self.high)) < _FINE_BELOW:
            return 0.0
        coarse = 10.0 * self.step
        return math.floor(self.low / coarse + 1e-6) * coarse

    @property
    def title(self) -> str:
        """Unit of its numbers, and what they count from."""
        if not self.in_fine:
            return self.unit.name
        if self.base == 0.0:
            return self.unit.fine
        return f"{self.unit.fine} above {self.base:.{_decimals(10.0 * self.step)}f} {self.unit.name}"

    def label(self, value: float) -> str:
        """Return the number that stands at a value."""
        if self.in_fine:
            return _number((value - self.base) * 1e3, self.step * 1e3)
        return _number(value, self.step)

    def marks(self) -> Floats:
        """Return the values with numbers, from the lower end upwards."""
        return self.low + self.step * np.arange(round(self.span / self.step) + 1)


def fold(low: Floats, high: Floats, seen: int, per_dot: int, dots: int) -> tuple[Floats, Floats]:
    """Return smallest and largest value of each column of dots; NaN where there was no sample at all.

    A column of dots always holds the same samples, whenever it is drawn: the trace moves and does not shimmer.

    Args:
        low: smallest value of each period, oldest first, NaN without a sample, shape (n,).
        high: largest value of each period, shape (n,).
        seen: number of the period after the last one, counted from any first one.
        per_dot: periods in one column of dots.
        dots: columns of dots; the last one holds the newest period.

    Returns:
        Smallest and largest value, each of shape (dots,).
    """
    first = ((seen - 1) // per_dot - dots + 1) * per_dot
    after = seen - first
    held = min(low.size, after)
    # NaN in front, where nothing is known yet, and behind, where the newest column of dots is not full.
    room = np.full((2, dots * per_dot), np.nan)
    room[0, after - held : after] = low[low.size - held :]
    room[1, after - held : after] = high[high.size - held :]
    both = room.reshape(2, dots, per_dot)
    return np.fmin.reduce(both[0], axis=1), np.fmax.reduce(both[1], axis=1)


def next_scale(old: Scale | None, low: float, high: float, unit: StripUnit = MM) -> Scale | None:
    """Return the scale for values between two; the old one as long as it does.

    Args:
        old: the scale so far; None before the first.
        low: smallest value; NaN when there is none.
        high: largest value.
        unit: of both; the old scale is none in another one.
    """
    if old is not None and old.unit != unit:
        old = None
    if not (math.isfinite(low) and math.isfinite(high)):
        return old
    if old is not None and _still_fits(old, low, high):
        return old
    step = max(_round_up((high - low) / _INTERVALS), _finest(low, high, unit))
    first, last = math.floor(low / step), math.ceil(high / step)
    if last - first < 2:
        first, last = first - 1, max(last, first + 1)
    return Scale(first * step, last * step, step, unit)


def draw(low: Floats, high: Floats, scale: Scale, columns: int, rows: int) -> list[Line]:
    """Return the chart: numbers and axis at the left, the trace at the right.

    Args:
        low: smallest value of each column of dots; NaN leaves it empty.
        high: largest value.
        columns: width in cells, numbers included.
        rows: height in cells.
    """
    canvas = Canvas(columns - LABEL_WIDTH, rows)
    if canvas.columns and canvas.rows:
        top, bottom = _joined(*(_bridged(ends[-canvas.width :]) for ends in (high, low)))
        per_unit = (canvas.height - 1) / scale.span
        canvas.bars((scale.high - top) * per_unit, (scale.high - bottom) * per_unit, TRACE)
    labels = _labels(scale, rows)
    return [
        [(labels.get(row, "").rjust(LABEL_WIDTH - 1) + ("┤" if row in labels else "│"), AXIS), *pieces]
        for row, pieces in enumerate(canvas.lines())
    ]


def arrays(lows: Sequence[float | None], highs: Sequence[float | None]) -> tuple[Floats, Floats]:
    """Return values as arrays; NaN for none."""
    return np.array(lows, dtype=np.float64), np.array(highs, dtype=np.float64)


def dots_of(columns: int) -> int:
    """Return the columns of dots of a chart that is so many cells wide."""
    return max(columns - LABEL_WIDTH, 0) * DOTS_ACROSS


def _bridged(ends: Floats) -> Floats:
    """Return extremes with straight lines between samples that came as fast as most do; what is longer is a gap."""
    known = np.flatnonzero(np.isfinite(ends))
    if known.size < _FEW:
        return ends
    between = np.diff(known)
    found: Floats = np.interp(np.arange(ends.size), known, ends[known], left=np.nan, right=np.nan)
    for place in np.flatnonzero(between > _MOST_BETWEEN * np.median(between)).tolist():
        found[known[place] + 1 : known[place + 1]] = np.nan
    return found


def _joined(high: Floats, low: Floats) -> tuple[Floats, Floats]:
    """Let each bar reach to the one before it, as a line does; a gap is not bridged."""
    top, bottom = high.copy(), low.copy()
    known = np.isfinite(high[1:])
    top[1:] = np.where(known, np.fmax(high[1:], low[:-1]), np.nan)
    bottom[1:] = np.where(known, np.fmin(low[1:], high[:-1]), np.nan)
    return top, bottom


def _labels(scale: Scale, rows: int) -> dict[int, str]:
    """Return numbers by row: both ends, and what has room between."""
    height = rows * DOTS_DOWN
    labels: dict[int, str] = {}
    marks = scale.marks()
    for value in (marks[0], marks[-1], *marks[1:-1]):
        row = round((scale.high - value) / scale.span * (height - 1)) // DOTS_DOWN
        if all(abs(row - other) > 1 for other in labels):
            labels[row] = scale.label(float(value))
    return labels


def _still_fits(scale: Scale, low: float, high: float) -> bool:
    """Return whether values lie within a scale and fill enough of it; the finest one is never too wide."""
    filled = (high - low) / scale.span
    finest = scale.step <= _finest(low, high, scale.unit)
    return scale.low <= low and high <= scale.high and (finest or filled >= _KEPT_SHARE)


def _finest(low: float, high: float, unit: StripUnit) -> float:
    """Return the finest step whose numbers a float still resolves, and that anybody wants to see."""
    return max(unit.finest, _round_up(1e-12 * max(abs(low), abs(high))))


def _round_up(value: float) -> float:
    """Return the next 1, 2 or 5 times a power of ten."""
    if value <= 0.0:
        return 0.0
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= value * (1.0 - 1e-9))


def _decimals(step: float) -> int:
    return max(0, -math.floor(math.log10(step) + 1e-9))


def _number(value: float, step: float) -> str:
    return number(value, fixed(_decimals(step)), minus="-")
