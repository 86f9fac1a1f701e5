"""Scales of axes: the ends are chosen so that every number stands exactly at the middle of its cell."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.app.tui.widgets.braille import DOTS_ACROSS, DOTS_DOWN, Floats

Ends = tuple[float, float]

_MANTISSAS: Final = ((1.0, 0.0), (2.0, 0.0), (5.0, 0.0), (2.5, 0.06), (4.0, 0.1), (3.0, 0.12))
"""Steps between two numbers but for powers of ten, and what is paid for those that are read less easily."""

_SPACING_COST: Final = 0.2
_MOST_WASTED: Final = 0.7
"""A scale is not widened by more than this share of the values."""

_ALWAYS_TWO: Final = 10
"""So many intervals leave two round values between any ends."""

_ROWS_WANTED: Final = 3.0
_CELLS_BETWEEN: Final = 2
"""Cells between the texts of two numbers across."""

_WITHIN_DECADES: Final = (
    (1.0,),
    (1.0, 2.0, 5.0),
    (1.0, 1.5, 2.0, 3.0, 5.0, 7.0),
    tuple(np.linspace(1.0, 9.9, 90).round(1).tolist()),
)


@dataclass(frozen=True)
class AxisKind:
    """What the numbers of an axis are.

    Attributes:
        decades: places are common logarithms, the numbers powers of ten.
        whole: there are whole numbers only.
        names: of the places 0, 1, 2 …, in place of numbers.
    """

    decades: bool = False
    whole: bool = False
    names: tuple[str, ...] = ()


@dataclass(frozen=True)
class AxisScale:
    """An axis over a number of cells.

    Attributes:
        ends: values at the middle of the first and of the last dot.
        marks: values with a number.
        texts: the numbers.
    """

    ends: Ends
    marks: Floats
    texts: tuple[str, ...]

    @property
    def widest(self) -> int:
        """Cells of the widest number."""
        return max(map(len, self.texts), default=0)


def upright_scale(ends: Ends, rows: int, kind: AxisKind) -> AxisScale:
    """Return the scale of an axis whose numbers stand beside it.

    Args:
        ends: what it has to hold.
        rows: its cells.
    """
    ends = _wide(ends)
    least = 2 if rows > 4 else 1
    wanted = max(_ROWS_WANTED, rows / 10.0)
    found = _aligned(ends, rows, DOTS_DOWN, wanted, kind, lambda _: least)
    return found or _nearest(ends, max(rows // 2, 1), kind)


def level_scale(ends: Ends, columns: int, kind: AxisKind) -> AxisScale:
    """Return the scale of an axis whose numbers stand below it.

    Args:
        ends: what it has to hold.
        columns: its cells.
    """
    ends = _wide(ends)

    def least(step: float) -> int:
        texts = kind.names or tuple(_text(end, step, kind) for end in ends)
        return max(map(len, texts)) + _CELLS_BETWEEN

    found = _aligned(ends, columns, DOTS_ACROSS, columns / 6.0, kind, least)
    return found or _nearest(ends, max(columns // 9, 1), kind)


def equal_scales(x: Ends, y: Ends, columns: int, rows: int) -> tuple[AxisScale, AxisScale]:
    """Return both scales with dots as wide as they are high: twice as many columns as rows between two numbers."""
    x, y = _wide(x), _wide(y)
    across, down = columns * DOTS_ACROSS - 1, rows * DOTS_DOWN - 1
    dot = max((x[1] - x[0]) / max(across, 1), (y[1] - y[0]) / max(down, 1))
    best: tuple[float, AxisScale, AxisScale] | None = None
    for step, price in _steps(DOTS_DOWN * dot, rows, whole=False):
        for per_step in _cells_a_step(step, DOTS_DOWN * dot, 1, rows):
            x_ends = _placed(x, step, 2 * per_step, columns, DOTS_ACROSS)
            y_ends = _placed(y, step, per_step, rows, DOTS_DOWN)
            cost = _cost(step / per_step / (DOTS_DOWN * dot), per_step, max(_ROWS_WANTED, rows / 10.0), price)
            if x_ends and y_ends and (best is None or cost < best[0]):
                best = cost, _scale(x_ends, step, AxisKind()), _scale(y_ends, step, AxisKind())
    if best is not None:
        return best[1:]
    middles = ((0.5 * (ends[0] + ends[1]), dots) for ends, dots in ((x, across), (y, down)))
    x, y = ((middle - 0.5 * dot * dots, middle + 0.5 * dot * dots) for middle, dots in middles)
    return _nearest(x, max(columns // 9, 1), AxisKind()), _nearest(y, max(rows // 2, 1), AxisKind())


def marks(ends: Ends, most: int, *, whole: bool = False) -> Floats:
    """Return round values between two ends, at most so many intervals.

    Args:
        whole: they are whole numbers.
    """
    raw = (ends[1] - ends[0]) / max(most, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(each * power for each in (1.0, 2.0, 5.0, 10.0) if each * power >= raw * (1.0 - 1e-9))
    return _multiples(ends, max(step, 1.0) if whole else step)


def number(value: float, step: float) -> str:
    """Return a number as exact as the step to the next one; the minus is a true one."""
    text = f"{value:.{_decimals(step)}f}"
    return "0" if float(text) == 0.0 else text.replace("-", "−")


def _aligned(
    ends: Ends, cells: int, dots: int, wanted: float, kind: AxisKind, least: Callable[[float], int]
) -> AxisScale | None:
    """Return the scale that wastes little and has numbers in good distances; None where there is none."""
    finest = (ends[1] - ends[0]) * dots / max(cells * dots - 1, 1)
    best: tuple[float, AxisScale] | None = None
    steps = [(1.0, 0.0)] if kind.names else _steps(finest, cells, whole=kind.whole or kind.decades)
    for step, price in steps:
        for per_step in _cells_a_step(step, finest, least(step), cells):
            cost = _cost(step / per_step / finest, per_step, wanted, price)
            if best is not None and cost >= best[0]:
                continue
            placed = _placed(ends, step, per_step, cells, dots)
            scale = None if placed is None else _scale(placed, step, kind)
            if scale is not None and scale.marks.size > 1:
                best = cost, scale
    return None if best is None else best[1]


def _steps(finest: float, cells: int, *, whole: bool) -> Iterator[tuple[float, float]]:
    """Yield steps from one cell to all of them, and what is paid for each."""
    first, last = math.floor(math.log10(finest)), math.ceil(math.log10(finest * max(cells, 1)))
    for power in range(first, last + 1):
        for mantissa, price in _MANTISSAS:
            step = mantissa * 10.0**power
            if not whole or (step > 1.0 - 1e-9 and abs(step - round(step)) < 1e-9):
                yield step, price


def _cells_a_step(step: float, finest: float, least: int, cells: int) -> Iterator[int]:
    """Yield the cells between two numbers for which the values have room, the most first."""
    most = min(math.floor(step / finest * (1.0 + 1e-9)), cells)
    for per_step in range(most, max(most - 3, least - 1, 0), -1):
        if step / per_step <= finest * (1.0 + _MOST_WASTED):
            yield per_step


def _cost(wasted: float, per_step: int, wanted: float, price: float) -> float:
    return wasted - 1.0 + _SPACING_COST * abs(math.log(per_step / wanted)) + price


def _placed(ends: Ends, step: float, per_step: int, cells: int, dots: int) -> Ends | None:
    """Return the ends of an axis with multiples of a step at middles of cells; None where the values stand out."""
    dot = step / per_step / dots
    slack = cells * dots - 1 - (ends[1] - ends[0]) / dot
    # The middle of a cell lies between its two middle dots.
    below = (ends[0] / dot + 0.5 * (dots - 1)) % dots
    more = min(round((0.5 * slack - below) / dots), math.floor((slack - below) / dots + 1e-9))
    below += dots * max(more, 0)
    if below > slack + 1e-6:
        return None
    low = ends[0] - below * dot
    return low, low + (cells * dots - 1) * dot


def _scale(ends: Ends, step: float, kind: AxisKind) -> AxisScale:
    if kind.names:
        places = np.arange(float(len(kind.names)))
        inside = (places >= ends[0]) & (places <= ends[1])
        return AxisScale(ends, places[inside], tuple(np.array(kind.names)[inside].tolist()))
    found = _multiples(ends, step)
    return AxisScale(ends, found, tuple(_text(mark, step, kind) for mark in found.tolist()))


def _nearest(ends: Ends, most: int, kind: AxisKind) -> AxisScale:
    """Return a scale with exactly these ends; its numbers stand in the nearest cells."""
    if kind.decades and (found := _within_decades(ends)).size:
        return AxisScale(ends, found, tuple(_power_text(10.0**mark) for mark in found.tolist()))
    if kind.names:
        return _scale(ends, 1.0, kind)
    every = (marks(ends, intervals, whole=kind.whole) for intervals in range(most, most + _ALWAYS_TWO))
    found = next((each for each in every if each.size > 1), np.zeros(0))
    step = float(found[1] - found[0]) if found.size else 1.0
    return AxisScale(ends, found, tuple(_text(mark, step, kind) for mark in found.tolist()))


def _power_text(value: float) -> str:
    """Return a round number of a logarithmic axis: 100, not 1e+02."""
    return f"{value:.0f}" if 100.0 <= round(value, 6) < 1e5 else f"{value:.2g}"


def _within_decades(ends: Ends) -> Floats:
    """Return logarithms of round numbers, at least two where there are as many."""
    powers = np.arange(math.floor(ends[0]), math.ceil(ends[1]) + 1)
    found = np.zeros(0)
    for mantissas in _WITHIN_DECADES:
        every = np.sort(np.add.outer(powers, np.log10(mantissas)).ravel())
        found = every[(every >= ends[0] - 1e-9) & (every <= ends[1] + 1e-9)]
        if found.size > 1:
            break
    return found


def _multiples(ends: Ends, step: float) -> Floats:
    first, last = math.ceil(ends[0] / step - 1e-9), math.floor(ends[1] / step + 1e-9)
    return step * np.arange(first, last + 1, dtype=np.float64)


def _text(mark: float, step: float, kind: AxisKind) -> str:
    return _power_text(10.0**mark) if kind.decades else number(mark, step)


def _decimals(step: float) -> int:
    """Return how many decimals tell multiples of a step apart, with all digits of the step."""
    if step <= 0.0:
        return 0
    first = max(0, -math.floor(math.log10(step) + 1e-9))
    return first if abs(step * 10.0**first - round(step * 10.0**first)) < 1e-6 else first + 1


def _wide(ends: Ends) -> Ends:
    low, high = ends
    return (low, high) if high - low > 1e-12 * max(abs(low), abs(high), 1e-6) else (low - 1.0, high + 1.0)
