"""Axes with numbers around a canvas of braille dots."""

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from catseye.app.tui.widgets.axis_scale import (
    AxisKind,
    AxisScale,
    Ends,
    equal_scales,
    level_scale,
    upright_scale,
)
from catseye.app.tui.widgets.braille import DOTS_ACROSS, DOTS_DOWN, Canvas, Floats

AXIS: Final = "axis"
"""Ink of axes and numbers."""

_TOP_CELLS: Final = 1
_WORTH_CELLS: Final = 4
"""A plot that is narrower shows nothing."""


@dataclass(frozen=True)
class Frame:
    """What stands around a plot.

    Attributes:
        title: above.
        x_label: below, at the right: in a line of its own, or in that of the axis.
        label_row: there is a line for it.
        x_numbers: numbers stand below; without them only the axis.
        y_numbers: numbers stand at the left; without them only the axis.
        left: cells left of the plot; more where the numbers need more.
        equal: both axes have one scale.
        x: what the numbers across are.
        y: what the numbers upwards are.
    """

    title: str = ""
    x_label: str = ""
    label_row: bool = False
    x_numbers: bool = True
    y_numbers: bool = True
    left: int = 0
    equal: bool = False
    x: AxisKind = field(default_factory=AxisKind)
    y: AxisKind = field(default_factory=AxisKind)

    @property
    def other_rows(self) -> int:
        """Rows that are no plot."""
        return _TOP_CELLS + 1 + self.x_numbers + self.has_label_row

    @property
    def has_label_row(self) -> bool:
        """Whether the label across has a line of its own."""
        return self.label_row and self.x_numbers


class Chart:
    """Places in two units become dots of a canvas.

    Args:
        columns: width in cells.
        rows: height in cells.
        x: smallest and largest value across.
        y: smallest and largest value upwards.
        frame: what stands around.

    Attributes:
        canvas: what is drawn.
        x: ends of the axis across.
        y: ends of the axis upwards.
    """

    def __init__(self, columns: int, rows: int, x: Ends, y: Ends, frame: Frame) -> None:
        self.canvas = Canvas(columns, rows)
        self.frame = frame
        self.plot_rows = max(self.canvas.rows - frame.other_rows, 1)
        self.left = max(frame.left, left_cells(y, self.plot_rows, frame))
        self._scales = self._fitted(x, y)
        while frame.y_numbers and self._scales[1].widest >= self.left and self.usable:
            # One scale for both axes reaches farther than the values, to longer numbers.
            self.left = self._scales[1].widest + 1
            self._scales = self._fitted(x, y)
        self.x, self.y = (scale.ends for scale in self._scales)
        self._draw_axes(*self._scales)
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
        across = DOTS_ACROSS * self.left + _share(x, self.x) * self._width
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
        x = self.x[0] + across[kept] / self._width * (self.x[1] - self.x[0])
        y = self.y[1] - down[kept] / self._height * (self.y[1] - self.y[0])
        return x, y

    def cells(self) -> tuple[Floats, Floats]:
        """Return the middles of the plot's cells, by row and column, both of shape (rows, columns)."""
        row, column = np.mgrid[0 : self.plot_rows, 0 : self.plot_columns]
        x = self.x[0] + (DOTS_ACROSS * column + 0.5) / self._width * (self.x[1] - self.x[0])
        y = self.y[1] - (DOTS_DOWN * row + 1.5) / self._height * (self.y[1] - self.y[0])
        return x, y

    def shade(self, row: int, column: int, letter: str, ink: str) -> None:
        """Write a letter into a cell of the plot."""
        self.canvas.text(self.left + column, _TOP_CELLS + row, letter, ink)

    @property
    def _width(self) -> float:
        return max(DOTS_ACROSS * self.plot_columns - 1.0, 1.0)

    @property
    def _height(self) -> float:
        return max(DOTS_DOWN * self.plot_rows - 1.0, 1.0)

    def _fitted(self, x: Ends, y: Ends) -> tuple[AxisScale, AxisScale]:
        if self.frame.equal:
            return equal_scales(x, y, self.plot_columns, self.plot_rows)
        return level_scale(x, self.plot_columns, self.frame.x), upright_scale(y, self.plot_rows, self.frame.y)

    def _draw_axes(self, x: AxisScale, y: AxisScale) -> None:
        canvas, bottom = self.canvas, _TOP_CELLS + self.plot_rows
        for row in range(_TOP_CELLS, bottom):
            canvas.text(self.left - 1, row, "│", AXIS)
        for mark, text in zip(y.marks.tolist(), y.texts, strict=True):
            shown = text if self.frame.y_numbers else ""
            canvas.text(0, self.cell(x.ends[0], mark)[1], shown.rjust(self.left - 1) + "┤", AXIS)
        canvas.text(self.left - 1, bottom, "└" + "─" * self.plot_columns, AXIS)
        self._draw_x_marks(x, bottom)
        if self.frame.x_numbers:
            row = bottom + 2 if self.frame.has_label_row else bottom
            canvas.text(canvas.columns - len(self.frame.x_label), row, self.frame.x_label, AXIS)

    def _draw_x_marks(self, scale: AxisScale, bottom: int) -> None:
        free = 0
        for mark, text in zip(scale.marks.tolist(), scale.texts, strict=True):
            column = self.cell(mark, self.y[0])[0]
            # No number begins before the last has ended, and none is cut at the end of the line.
            begin = min(column - len(text) // 2, self.canvas.columns - len(text))
            self.canvas.text(column, bottom, "┴", AXIS)
            if self.frame.x_numbers and begin >= free:
                self.canvas.text(begin, bottom + 1, text, AXIS)
                free = begin + len(text) + 1


def left_cells(y: Ends, plot_rows: int, frame: Frame) -> int:
    """Return how many cells the numbers of an axis and the axis need."""
    return (upright_scale(y, plot_rows, frame.y).widest if frame.y_numbers else 0) + 1


def _share(value: Floats | float, ends: Ends) -> Floats:
    return np.asarray((np.asarray(value, dtype=np.float64) - ends[0]) / (ends[1] - ends[0]))
