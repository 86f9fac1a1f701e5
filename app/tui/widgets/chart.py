"""A chart with axes, of braille dots and letters."""

import math
from itertools import pairwise
from typing import Final

import numpy as np

from catseye.app.tui.widgets.braille import DOTS_ACROSS, DOTS_DOWN, Canvas, Floats

AXIS: Final = "axis"

_TOP_CELLS: Final = 1
_BOTTOM_CELLS: Final = 2
_DASH: Final = 2


class Chart:
    """Places in two units become dots; numbers stand at the left and below.

    Args:
        columns: width in cells.
        rows: height in cells.
        x: smallest and largest value across.
        y: smallest and largest value upwards.
        x_unit: stands behind the numbers below.
        title: stands above, with the unit upwards.
        x_step: between two numbers below; a round one where it is not given.

    Attributes:
        canvas: what is drawn.
    """

    def __init__(
        self,
        columns: int,
        rows: int,
        x: tuple[float, float],
        y: tuple[float, float],
        *,
        x_unit: str,
        title: str,
        x_step: float | None = None,
    ) -> None:
        self.canvas = Canvas(columns, rows)
        self._x, self._y = _wide(x), _wide(y)
        plot_rows = max(rows - _TOP_CELLS - _BOTTOM_CELLS, 1)
        y_marks = _at_least_two(self._y, plot_rows)
        labels = [number(mark, _step(y_marks)) for mark in y_marks]
        self._left = max((len(label) for label in labels), default=0) + 1
        self._plot_rows = plot_rows
        self._draw_axes(labels, y_marks, x_unit, x_step)
        self.canvas.text(0, 0, title, AXIS)

    @property
    def usable(self) -> bool:
        """There is room for more than the axes."""
        return self.canvas.columns > self._left + 4 and self.canvas.rows > _TOP_CELLS + _BOTTOM_CELLS

    def dot(self, x: Floats | float, y: Floats | float) -> tuple[Floats, Floats]:
        """Return where places are, dots from the upper left corner."""
        left, width = DOTS_ACROSS * self._left, DOTS_ACROSS * (self.canvas.columns - self._left)
        height = DOTS_DOWN * self._plot_rows
        across = left + 1.0 + _share(x, self._x) * (width - 4)
        down = DOTS_DOWN * _TOP_CELLS + (1.0 - _share(y, self._y)) * (height - 1)
        return across, down

    def points(self, x: Floats, y: Floats, ink: str) -> None:
        """Draw dots."""
        self.canvas.points(*self.dot(x, y), ink)

    def line(self, x: Floats, y: Floats, ink: str, dash: int = 0) -> None:
        """Draw straight lines from place to place."""
        across, down = self.dot(x, y)
        places = list(zip(across.tolist(), down.tolist(), strict=True))
        for start, end in pairwise(places):
            self.canvas.line(start, end, ink, dash)

    def level(self, y: float, ink: str, dash: int = _DASH) -> None:
        """Draw a line across, where y lies inside."""
        if self._y[0] <= y <= self._y[1]:
            self.line(np.array(self._x), np.array([y, y]), ink, dash)

    def upright(self, x: float, ink: str) -> None:
        """Draw a line from bottom to top."""
        self.line(np.array([x, x]), np.array(self._y), ink, _DASH)

    def bars(self, x: Floats, low: Floats, high: Floats, ink: str, aside: int = 0) -> None:
        """Draw upright bars.

        Args:
            x: where.
            low: lower ends.
            high: upper ends.
            ink: of the bars.
            aside: dots to the right, so that two bars at one place are seen.
        """
        across, bottom = self.dot(x, low)
        _, top = self.dot(x, high)
        for place, start, end in zip(across.tolist(), bottom.tolist(), top.tolist(), strict=True):
            self.canvas.line((place + aside, start), (place + aside, end), ink)

    def cell(self, x: float, y: float) -> tuple[int, int]:
        """Return column and row of the cell in which a place is."""
        across, down = self.dot(x, y)
        return round(float(across)) // DOTS_ACROSS, round(float(down)) // DOTS_DOWN

    def letter(self, x: float, y: float, letter: str, ink: str) -> None:
        """Write a letter at a place."""
        if math.isfinite(x) and math.isfinite(y):
            self.canvas.text(*self.cell(x, y), letter, ink)

    def heading(self, x: float, text: str, ink: str) -> None:
        """Write above a place."""
        self.canvas.text(self.cell(x, self._y[1])[0], 0, text, ink)

    def _draw_axes(self, labels: list[str], y_marks: Floats, x_unit: str, x_step: float | None) -> None:
        canvas, bottom = self.canvas, _TOP_CELLS + self._plot_rows
        for row in range(_TOP_CELLS, bottom):
            canvas.text(self._left - 1, row, "│", AXIS)
        for label, mark in zip(labels, y_marks.tolist(), strict=True):
            row = self.cell(self._x[0], mark)[1]
            canvas.text(0, row, label.rjust(self._left - 1) + "┤", AXIS)
        canvas.text(self._left - 1, bottom, "└" + "─" * (canvas.columns - self._left), AXIS)
        self._draw_x_marks(bottom, x_unit, x_step)
        self.level(0.0, AXIS)

    def _draw_x_marks(self, bottom: int, x_unit: str, x_step: float | None) -> None:
        room = max((self.canvas.columns - self._left) // 8, 1)
        found = marks(self._x, room)
        if x_step is not None:
            every = math.ceil((self._x[1] - self._x[0]) / x_step / room) * x_step
            first = math.ceil(self._x[0] / every - 1e-9)
            found = every * np.arange(first, math.floor(self._x[1] / every + 1e-9) + 1)
        taken = self.canvas.columns - len(x_unit)
        self.canvas.text(taken, bottom + 1, x_unit, AXIS)
        for mark in found.tolist():
            column = self.cell(mark, self._y[0])[0]
            text = number(mark, _step(found))
            begin = column - len(text) // 2
            self.canvas.text(column, bottom, "┴", AXIS)
            if begin >= 0 and begin + len(text) < taken:
                self.canvas.text(begin, bottom + 1, text, AXIS)


def marks(ends: tuple[float, float], most: int) -> Floats:
    """Return round values between two ends, at most so many intervals."""
    raw = (ends[1] - ends[0]) / max(most, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(each * power for each in (1.0, 2.0, 5.0, 10.0) if each * power >= raw * (1.0 - 1e-9))
    first, last = math.ceil(ends[0] / step - 1e-9), math.floor(ends[1] / step + 1e-9)
    return step * np.arange(first, last + 1, dtype=np.float64)


def _at_least_two(ends: tuple[float, float], rows: int) -> Floats:
    """Return round values with two rows for each, but two of them where there is room."""
    found = marks(ends, max(rows // 2, 1))
    return found if found.size > 1 else marks(ends, max(rows, 2))


def number(value: float, step: float) -> str:
    """Return a number as exact as the step to the next one; the minus is a true one."""
    decimals = max(0, -math.floor(math.log10(step) + 1e-9)) if step > 0.0 else 0
    text = f"{value:.{decimals}f}"
    return "0" if float(text) == 0.0 else text.replace("-", "−")


def ends_of(*values: Floats) -> tuple[float, float]:
    """Return smallest and largest of all finite values and zero, a little apart."""
    every = np.concatenate([np.zeros(1), *(np.ravel(each) for each in values)])
    every = every[np.isfinite(every)]
    low, high = float(every.min()), float(every.max())
    apart = 0.04 * (high - low)
    return low - apart, high + apart


def _wide(ends: tuple[float, float]) -> tuple[float, float]:
    low, high = ends
    return (low, high) if high - low > 1e-12 * max(abs(low), abs(high), 1e-6) else (low - 1.0, high + 1.0)


def _share(value: Floats | float, ends: tuple[float, float]) -> Floats:
    return np.asarray((np.asarray(value, dtype=np.float64) - ends[0]) / (ends[1] - ends[0]))


def _step(found: Floats) -> float:
    return float(found[1] - found[0]) if found.size > 1 else abs(float(found[0])) if found.size else 1.0
