"""Axes with numbers around a canvas of braille dots."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.app.tui.widgets.braille import DOTS_ACROSS, DOTS_DOWN, Canvas, Floats

AXIS: Final = "axis"
"""Ink of axes and numbers."""

Ends = tuple[float, float]

_TOP_CELLS: Final = 1
_MARK_CELLS: Final = 9
_WORTH_CELLS: Final = 4
"""A plot that is narrower shows nothing."""


@dataclass(frozen=True)
class Frame:
    """What stands around a plot.

    Attributes:
        title: above.
        x_label: below, at the right.
        x_numbers: numbers stand below; without them only the axis.
        y_numbers: numbers stand at the left; without them only the axis.
        left: cells left of the plot; more where the numbers need more.
        equal: both axes have one scale.
        x_decades: places across are common logarithms, the numbers below are powers of ten.
        y_decades: likewise upwards.
        x_names: of the places 0, 1, 2 … across, in place of numbers.
        counts: there are whole numbers only across, and upwards.
    """

    title: str = ""
    x_label: str = ""
    x_numbers: bool = True
    y_numbers: bool = True
    left: int = 0
    equal: bool = False
    x_decades: bool = False
    y_decades: bool = False
    x_names: tuple[str, ...] = ()
    counts: tuple[bool, bool] = (False, False)

    @property
    def other_rows(self) -> int:
        """Rows that are no plot."""
        return _TOP_CELLS + 1 + self.x_numbers


class Chart:
    """Places in two units become dots of a canvas.

    Args:
        columns: width in cells.
        rows: height in cells.
        x: smallest and largest value across.
        y: smallest and largest value upwards.

    Attributes:
        canvas: what is drawn.
        x: ends of the axis across.
        y: ends of the axis upwards.
    """

    def __init__(self, columns: int, rows: int, x: Ends, y: Ends, frame: Frame) -> None:
        self.canvas = Canvas(columns, rows)
        self.frame = frame
        self.x, self.y = _wide(x), _wide(y)
        self.plot_rows = max(self.canvas.rows - frame.other_rows, 1)
        self.left = max(frame.left, _left_cells(self.y, self.plot_rows, frame))
        if frame.equal:
            self._equalise()
        self._draw_axes()
        self.canvas.text(0, 0, frame.title, AXIS)

    @property
    def plot_columns(self) -> int:
        """Width of the plot in cells."""
        return max(self.canvas.columns - self.left, 1)

    @property
    def usable(self) -> bool:
        """There is room for more than the axes."""
        return self.plot_columns > _WORTH_CELLS and self.canvas.rows > self.frame.other_rows

    def dot(self, x: Floats | float, y: Floats | float) -> tuple[Floats, Floats]:
        """Return where places are, dots from the upper left corner."""
        across = DOTS_ACROSS * self.left + 1.0 + _share(x, self.x) * self._width
        down = DOTS_DOWN * _TOP_CELLS + (1.0 - _share(y, self.y)) * self._height
        return across, down

    def line(self, x: Floats, y: Floats, ink: str, dash: int = 0) -> None:
        """Draw straight lines from place to place; NaN interrupts them."""
        self.canvas.polyline(*self.dot(x, y), ink, dash)

    def points(self, x: Floats, y: Floats, ink: str) -> None:
        """Draw dots."""
        self.canvas.points(*self.dot(x, y), ink)

    def bars(self, x: Floats, low: Floats, high: Floats, ink: str) -> None:
        """Draw upright lines, each with shape (n,)."""
        gap = np.full(x.size, np.nan)
        across, upwards = np.column_stack([x, x, gap]).ravel(), np.column_stack([low, high, gap]).ravel()
        self.line(across, upwards, ink)

    def cell(self, x: float, y: float) -> tuple[int, int]:
        """Return column and row of the cell in which a place is."""
        across, down = self.dot(x, y)
        return round(float(across)) // DOTS_ACROSS, round(float(down)) // DOTS_DOWN

    def inside(self, x: float, y: float) -> bool:
        """Return whether a place lies on the plot."""
        return self.x[0] <= x <= self.x[1] and self.y[0] <= y <= self.y[1]

    def lattice(self) -> tuple[Floats, Floats]:
        """Return the places of every fourth dot of the plot: what fills an area."""
        down, across = np.mgrid[0 : self.plot_rows * DOTS_DOWN, 0 : self.plot_columns * DOTS_ACROSS]
        kept = (down + 2 * across) % DOTS_DOWN == 0
        x = self.x[0] + (across[kept] - 1.0) / self._width * (self.x[1] - self.x[0])
        y = self.y[1] - down[kept] / self._height * (self.y[1] - self.y[0])
        return x, y

    def cells(self) -> tuple[Floats, Floats]:
        """Return the middles of the plot's cells, by row and column, both of shape (rows, columns)."""
        row, column = np.mgrid[0 : self.plot_rows, 0 : self.plot_columns]
        x = self.x[0] + (DOTS_ACROSS * column - 0.5) / self._width * (self.x[1] - self.x[0])
        y = self.y[1] - (DOTS_DOWN * row + 1.5) / self._height * (self.y[1] - self.y[0])
        return x, y

    def shade(self, row: int, column: int, letter: str, ink: str) -> None:
        """Write a letter into a cell of the plot."""
        self.canvas.text(self.left + column, _TOP_CELLS + row, letter, ink)

    @property
    def _width(self) -> float:
        return max(DOTS_ACROSS * self.plot_columns - 4.0, 1.0)

    @property
    def _height(self) -> float:
        return max(DOTS_DOWN * self.plot_rows - 1.0, 1.0)

    def _equalise(self) -> None:
        """Widen the shorter axis until a dot is as wide as it is high."""
        unit = max((self.x[1] - self.x[0]) / self._width, (self.y[1] - self.y[0]) / self._height)
        self.x, self.y = (
            (0.5 * (low + high) - 0.5 * unit * dots, 0.5 * (low + high) + 0.5 * unit * dots)
            for (low, high), dots in ((self.x, self._width), (self.y, self._height))
        )

    def _draw_axes(self) -> None:
        canvas, bottom = self.canvas, _TOP_CELLS + self.plot_rows
        for row in range(_TOP_CELLS, bottom):
            canvas.text(self.left - 1, row, "│", AXIS)
        y_marks = _at_least_two(self.y, self.plot_rows, whole=self.frame.counts[1])
        for mark in y_marks.tolist():
            label = _label(mark, y_marks, decades=self.frame.y_decades) if self.frame.y_numbers else ""
            canvas.text(0, self.cell(self.x[0], mark)[1], label.rjust(self.left - 1) + "┤", AXIS)
        canvas.text(self.left - 1, bottom, "└" + "─" * self.plot_columns, AXIS)
        self._draw_x_marks(bottom)

    def _draw_x_marks(self, bottom: int) -> None:
        names = self.frame.x_names
        most, whole = max(self.plot_columns // _MARK_CELLS, 1), self.frame.counts[0]
        found = np.arange(float(len(names))) if names else marks(self.x, most, whole=whole)
        free, taken = 0, self.canvas.columns - len(self.frame.x_label)
        if self.frame.x_numbers:
            self.canvas.text(taken, bottom + 1, self.frame.x_label, AXIS)
        texts = names or [_label(mark, found, decades=self.frame.x_decades) for mark in found.tolist()]
        for mark, text in zip(found.tolist(), texts, strict=True):
            column = self.cell(mark, self.y[0])[0]
            begin = column - len(text) // 2
            self.canvas.text(column, bottom, "┴", AXIS)
            if self.frame.x_numbers and begin >= free and begin + len(text) < taken:
                self.canvas.text(begin, bottom + 1, text, AXIS)
                free = begin + len(text) + 1


def label_cells(y: Ends, plot_rows: int, *, decades: bool = False, whole: bool = False) -> int:
    """Return how many cells the numbers of an axis and the axis need."""
    found = _at_least_two(_wide(y), plot_rows, whole=whole)
    return max((len(_label(mark, found, decades=decades)) for mark in found.tolist()), default=0) + 1


def _left_cells(y: Ends, plot_rows: int, frame: Frame) -> int:
    if not frame.y_numbers:
        return 1
    return label_cells(y, plot_rows, decades=frame.y_decades, whole=frame.counts[1])


def _label(mark: float, found: Floats, *, decades: bool) -> str:
    """Return the number at one of the marks of an axis."""
    return f"{10.0**mark:.2g}" if decades else number(mark, _step(found))


def marks(ends: Ends, most: int, *, whole: bool = False) -> Floats:
    """Return round values between two ends, at most so many intervals.

    Args:
        whole: they are whole numbers.
    """
    raw = (ends[1] - ends[0]) / max(most, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(each * power for each in (1.0, 2.0, 5.0, 10.0) if each * power >= raw * (1.0 - 1e-9))
    step = max(step, 1.0) if whole else step
    first, last = math.ceil(ends[0] / step - 1e-9), math.floor(ends[1] / step + 1e-9)
    return step * np.arange(first, last + 1, dtype=np.float64)


def _at_least_two(ends: Ends, rows: int, *, whole: bool) -> Floats:
    """Return round values with two rows for each, but two of them where there is room."""
    found = marks(ends, max(rows // 2, 1), whole=whole)
    return found if found.size > 1 else marks(ends, max(rows, 2), whole=whole)


def number(value: float, step: float) -> str:
    """Return a number as exact as the step to the next one; the minus is a true one."""
    decimals = max(0, -math.floor(math.log10(step) + 1e-9)) if step > 0.0 else 0
    text = f"{value:.{decimals}f}"
    return "0" if float(text) == 0.0 else text.replace("-", "−")


def _wide(ends: Ends) -> Ends:
    low, high = ends
    return (low, high) if high - low > 1e-12 * max(abs(low), abs(high), 1e-6) else (low - 1.0, high + 1.0)


def _share(value: Floats | float, ends: Ends) -> Floats:
    return np.asarray((np.asarray(value, dtype=np.float64) - ends[0]) / (ends[1] - ends[0]))


def _step(found: Floats) -> float:
    return float(found[1] - found[0]) if found.size > 1 else abs(float(found[0])) if found.size else 1.0
