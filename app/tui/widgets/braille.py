"""Drawing with braille characters: two by four dots in a cell of the terminal, one ink a cell."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating[Any]]

DOTS_ACROSS: Final = 2
DOTS_DOWN: Final = 4

_BITS: Final = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]], dtype=np.uint8)
"""Bit of each dot of a cell, by row and column, as Unicode numbers the dots."""

_LETTERS: Final = np.array([" ", *(chr(0x2800 + code) for code in range(1, 256))])
"""Letter of each set of dots; none is a blank, which every font has."""


class Canvas:
    """A drawing of dots and letters.

    Dots are counted from the upper left corner: x to the right, y downwards. What lies outside is not drawn. The ink
    that came last is the ink of its cell; letters stand above dots.

    Args:
        columns: width in cells.
        rows: height in cells.

    Attributes:
        columns: width in cells.
        rows: height in cells.
        dots: which are set, by row and column.
    """

    def __init__(self, columns: int, rows: int) -> None:
        self.columns = max(columns, 0)
        self.rows = max(rows, 0)
        self.dots: NDArray[np.bool_] = np.zeros((self.rows * DOTS_DOWN, self.columns * DOTS_ACROSS), np.bool_)
        self._inks: list[str] = [""]
        self._ink: NDArray[np.int16] = np.zeros((self.rows, self.columns), np.int16)
        self._letters: dict[tuple[int, int], tuple[str, int]] = {}

    @property
    def width(self) -> int:
        """Width in dots."""
        return self.columns * DOTS_ACROSS

    @property
    def height(self) -> int:
        """Height in dots."""
        return self.rows * DOTS_DOWN

    def points(self, x: Floats | float, y: Floats | float, ink: str = "") -> None:
        """Set the dots that are nearest to points; what is not finite is left out."""
        across, down = np.broadcast_arrays(np.atleast_1d(x), np.atleast_1d(y))
        finite = np.isfinite(across) & np.isfinite(down)
        # Far-away points are cut before they are whole numbers: no integer overflows.
        column = np.clip(_dot(across[finite]), -1, self.width).astype(np.intp)
        row = np.clip(_dot(down[finite]), -1, self.height).astype(np.intp)
        inside = (column >= 0) & (column < self.width) & (row >= 0) & (row < self.height)
        self._set(row[inside], column[inside], ink)

    def line(
        self, start: tuple[float, float], end: tuple[float, float], ink: str = "", dash: int = 0
    ) -> None:
        """Draw a straight line without holes.

        Args:
            start: x and y.
            end: x and y.
            dash: dots drawn and dots left out, by turns; 0 leaves none out.
        """
        if not all(map(math.isfinite, (*start, *end))):
            return
        cut = self._visible_part(start, end)
        if cut is None:
            return
        (x0, y0), (x1, y1) = cut
        steps = math.ceil(max(abs(x1 - x0), abs(y1 - y0))) + 1
        share = np.linspace(0.0, 1.0, max(steps, 2))
        if dash:
            share = share[np.arange(share.size) // dash % 2 == 0]
        self.points(x0 + share * (x1 - x0), y0 + share * (y1 - y0), ink)

    def polyline(self, x: Floats, y: Floats, ink: str = "", dash: int = 0) -> None:
        """Draw straight lines from point to point; one that is not finite interrupts them.

        Args:
            x: shape (n,).
            y: shape (n,).
            dash: dots drawn and dots left out, by turns along the whole line; 0 leaves none out.
        """
        length = np.maximum(np.abs(np.diff(x)), np.abs(np.diff(y)))
        drawn = np.isfinite(length)
        far = drawn & (length > self.width + self.height)
        for place in np.flatnonzero(far).tolist():
            self.line(
                (float(x[place]), float(y[place])), (float(x[place + 1]), float(y[place + 1])), ink, dash
            )
        start = np.flatnonzero(drawn & ~far)
        steps = np.ceil(length[start]).astype(np.intp) + 1
        number = np.arange(steps.sum())
        within = number - np.repeat(np.cumsum(steps) - steps, steps)
        if dash:
            kept = number // dash % 2 == 0
            within, start, steps = within[kept], np.repeat(start, steps)[kept], np.repeat(steps, steps)[kept]
        else:
            start, steps = np.repeat(start, steps), np.repeat(steps, steps)
        share = within / np.maximum(steps - 1, 1)
        self.points(
            x[start] + share * (x[start + 1] - x[start]), y[start] + share * (y[start + 1] - y[start]), ink
        )

    def arc(
        self,
        centre: tuple[float, float],
        radius: float,
        start_rad: float,
        end_rad: float,
        ink: str = "",
        dash: int = 0,
    ) -> None:
        """Draw an arc of a circle, counter-clockwise as it is seen.

        Args:
            centre: x and y.
            radius: in dots.
            start_rad: direction from the centre, from the right counter-clockwise.
            end_rad: likewise; beyond the start.
            dash: dots drawn and dots left out, by turns; 0 leaves none out.
        """
        steps = math.ceil(radius * abs(end_rad - start_rad)) + 2
        angle = np.linspace(start_rad, end_rad, steps)
        if dash:
            angle = angle[np.arange(steps) // dash % 2 == 0]
        self.points(centre[0] + radius * np.cos(angle), centre[1] - radius * np.sin(angle), ink)

    def circle(self, centre: tuple[float, float], radius: float, ink: str = "") -> None:
        """Draw a circle."""
        self.arc(centre, radius, 0.0, 2.0 * math.pi, ink)

    def bars(self, top: Floats, bottom: Floats, ink: str = "") -> None:
        """Draw one upright bar in each column of dots, from the left; a column that is not finite stays empty.

        Args:
            top: smaller y, one for each column of dots.
            bottom: larger y.
        """
        count = min(top.size, self.width)
        drawn = np.isfinite(top[:count]) & np.isfinite(bottom[:count])
        first = np.full(count, 1.0)
        last = np.full(count, 0.0)
        first[drawn] = np.rint(top[:count][drawn])
        last[drawn] = np.rint(bottom[:count][drawn])
        level = np.arange(self.height)[:, None]
        row, column = np.nonzero((level >= first) & (level <= last))
        self._set(row, column, ink)

    def text(self, column: int, row: int, text: str, ink: str = "") -> None:
        """Write letters, one a cell."""
        for place, letter in enumerate(text, column):
            if 0 <= place < self.columns and 0 <= row < self.rows:
                self._letters[row, place] = (letter, self._number(ink))

    def letter(self, column: int, row: int) -> str:
        """Return the letter in a cell; empty where there is none."""
        return self._letters.get((row, column), ("", 0))[0]

    def lines(self) -> Iterator[list[tuple[str, str]]]:
        """Yield each line of cells as pieces of text with their ink; empty cells are blanks."""
        cells = self.dots.reshape(self.rows, DOTS_DOWN, self.columns, DOTS_ACROSS)
        codes = np.einsum("rdca,da->rc", cells, _BITS, dtype=np.uint8, casting="unsafe")
        letters, inks = _LETTERS[codes], np.where(codes > 0, self._ink, 0)
        for (row, column), (letter, ink) in self._letters.items():
            letters[row, column], inks[row, column] = letter, ink
        for line, line_inks in zip(letters.tolist(), inks, strict=True):
            text = "".join(line)
            cuts = [0, *(np.flatnonzero(np.diff(line_inks)) + 1).tolist(), self.columns]
            yield [(text[cut:end], self._inks[line_inks[cut]]) for cut, end in pairwise(cuts) if end > cut]

    def plain(self) -> list[str]:
        """Return the lines without ink."""
        return ["".join(text for text, _ in line) for line in self.lines()]

    def _set(self, row: NDArray[np.intp], column: NDArray[np.intp], ink: str) -> None:
        self.dots[row, column] = True
        self._ink[row // DOTS_DOWN, column // DOTS_ACROSS] = self._number(ink)

    def _number(self, ink: str) -> int:
        if ink not in self._inks:
            self._inks.append(ink)
        return self._inks.index(ink)

    def _visible_part(
        self, start: tuple[float, float], end: tuple[float, float]
    ) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """Return what of a line lies within a cell of the canvas (Liang and Barsky); None when nothing does."""
        first, last = 0.0, 1.0
        for begin, finish, size in ((start[0], end[0], self.width), (start[1], end[1], self.height)):
            way = finish - begin
            low, high = -DOTS_DOWN - begin, size + DOTS_DOWN - begin
            if way == 0.0:
                if low > 0.0 or high < 0.0:
                    return None
                continue
            enter, leave = sorted((low / way, high / way))
            first, last = max(first, enter), min(last, leave)
        if first > last:
            return None

        def at(share: float) -> tuple[float, float]:
            return start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])

        return at(first), at(last)


def _dot(place: Floats) -> Floats:
    """Return the nearest dots; half-way between two it is always the later one: lines there have no holes."""
    found: Floats = np.floor(place + (0.5 + 1e-6))
    return found
