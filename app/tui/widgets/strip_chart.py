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
_FINEST_STEP_MM: Final = 1e-4
_KEPT_SHARE: Final = 0.25
"""A scale stays as long as the values fill so much of it."""

_UM_BELOW_MM: Final = 1.0


@dataclass(frozen=True)
class Scale:
    """The upright axis.

    Attributes:
        low_mm: its lower end.
        high_mm: its upper end.
        step_mm: between two numbers; 1, 2 or 5 times a power of ten.
    """

    low_mm: float
    high_mm: float
    step_mm: float

    @property
    def span_mm(self) -> float:
        """Its length."""
        return self.high_mm - self.low_mm

    @property
    def in_um(self) -> bool:
        """Its numbers are µm from `base_mm`, not mm."""
        return self.span_mm < _UM_BELOW_MM

    @property
    def base_mm(self) -> float:
        """What its numbers count from; zero where they are mm, or small."""
        if not self.in_um or max(abs(self.low_mm), abs(self.high_mm)) < _UM_BELOW_MM:
            return 0.0
        round_mm = 10.0 * self.step_mm
        return math.floor(self.low_mm / round_mm + 1e-6) * round_mm

    @property
    def title(self) -> str:
        """Unit of its numbers, and what they count from."""
        if not self.in_um:
            return "mm"
        if self.base_mm == 0.0:
            return "µm"
        return f"µm above {self.base_mm:.{_decimals(10.0 * self.step_mm)}f} mm"

    def label(self, value_mm: float) -> str:
        """Return the number that stands at a value."""
        if self.in_um:
            return _number((value_mm - self.base_mm) * 1e3, self.step_mm * 1e3)
        return _number(value_mm, self.step_mm)

    def marks_mm(self) -> Floats:
        """Return the values with numbers, from the lower end upwards."""
        return self.low_mm + self.step_mm * np.arange(round(self.span_mm / self.step_mm) + 1)


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


def next_scale(old: Scale | None, low_mm: float, high_mm: float) -> Scale | None:
    """Return the scale for values between two; the old one as long as it does.

    Args:
        old: the scale so far; None before the first.
        low_mm: smallest value; NaN when there is none.
        high_mm: largest value.
    """
    if not (math.isfinite(low_mm) and math.isfinite(high_mm)):
        return old
    if old is not None and _still_fits(old, low_mm, high_mm):
        return old
    step_mm = max(_round_up((high_mm - low_mm) / _INTERVALS), _finest_mm(low_mm, high_mm))
    first, last = math.floor(low_mm / step_mm), math.ceil(high_mm / step_mm)
    if last - first < 2:
        first, last = first - 1, max(last, first + 1)
    return Scale(first * step_mm, last * step_mm, step_mm)


def draw(low_mm: Floats, high_mm: Floats, scale: Scale, columns: int, rows: int) -> list[Line]:
    """Return the chart: numbers and axis at the left, the trace at the right.

    Args:
        low_mm: smallest value of each column of dots; NaN leaves it empty.
        high_mm: largest value.
        columns: width in cells, numbers included.
        rows: height in cells.
    """
    canvas = Canvas(columns - LABEL_WIDTH, rows)
    if canvas.columns and canvas.rows:
        top, bottom = _joined(high_mm[-canvas.width :], low_mm[-canvas.width :])
        per_mm = (canvas.height - 1) / scale.span_mm
        canvas.bars((scale.high_mm - top) * per_mm, (scale.high_mm - bottom) * per_mm, TRACE)
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
    marks_mm = scale.marks_mm()
    for value_mm in (marks_mm[0], marks_mm[-1], *marks_mm[1:-1]):
        row = round((scale.high_mm - value_mm) / scale.span_mm * (height - 1)) // DOTS_DOWN
        if all(abs(row - other) > 1 for other in labels):
            labels[row] = scale.label(float(value_mm))
    return labels


def _still_fits(scale: Scale, low_mm: float, high_mm: float) -> bool:
    """Return whether values lie within a scale and fill enough of it; the finest one is never too wide."""
    filled = (high_mm - low_mm) / scale.span_mm
    finest = scale.step_mm <= _finest_mm(low_mm, high_mm)
    return scale.low_mm <= low_mm and high_mm <= scale.high_mm and (finest or filled >= _KEPT_SHARE)


def _finest_mm(low_mm: float, high_mm: float) -> float:
    """Return the finest step whose numbers a float still resolves, and that anybody wants to see."""
    return max(_FINEST_STEP_MM, _round_up(1e-12 * max(abs(low_mm), abs(high_mm))))


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
