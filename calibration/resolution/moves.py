"""The moves commanded during a recording: when, and by how much."""

from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.arguments import require_one_of, require_shape
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.units import Unit, shown

_EQUAL = 1e-6
"""Sizes that differ by this share were written with fewer digits."""


@dataclass(frozen=True)
class Moves:
    """Commanded moves in their order.

    Attributes:
        time_s: when each was commanded, by the recording's clock, s, shape (n,).
        command: its signed size, shape (n,).
        unit: of the command.
        first: number of the first one; above 1 in a part of a series.
    """

    time_s: Floats
    command: Floats
    unit: Unit
    first: int = 1

    def __len__(self) -> int:
        return int(self.time_s.size)

    @property
    def dwell_s(self) -> float:
        """Usual time from one move to the next, s."""
        return float(np.median(np.diff(self.time_s)))

    @property
    def directions(self) -> Ints:
        """Sign of each move, shape (n,)."""
        return np.sign(self.command).astype(np.int64)

    def equal_size(self) -> float:
        """Return the size of moves that are all of one size.

        Raises:
            MovesError: one of them differs.
        """
        size = np.abs(self.command)
        other = np.flatnonzero(np.abs(size - size[0]) > _EQUAL * size[0])
        if other.size:
            found, first = (shown(float(self.command[k]), self.unit) for k in (int(other[0]), 0))
            number = int(other[0]) + self.first
            raise MovesError(
                f"move {number} is {found}, the first one {first}: this test has steps of one size; evaluate each "
                "size by itself, or state which test it was",
                number,
            )
        return float(size[0])

    def part(self, first: int, end: int) -> "Moves":
        """Return some of them, by their places from 0, which keep their numbers."""
        return Moves(self.time_s[first:end], self.command[first:end], self.unit, self.first + first)

    def delayed(self, offset_s: float, drift: float, about_s: float) -> "Moves":
        """Return the moves at the times that another clock shows.

        Args:
            offset_s: what it is ahead at `about_s`, s.
            drift: what it gains a second.
            about_s: by the moves' own clock, s.
        """
        return replace(self, time_s=self.time_s + offset_s + drift * (self.time_s - about_s))


def moves_of(time_s: Floats, command: Floats, unit: Unit) -> Moves:
    """Return moves of their times and sizes.

    Args:
        time_s: s, shape (n,).
        command: rad or mm, shape (n,).

    Raises:
        MovesError: fewer than two moves, times that do not increase, a number that is missing, a move of size zero.
        ArgumentError: the columns are of different length, or the unit is unknown.
    """
    require_one_of(Unit, unit, "unit")
    require_shape(command, time_s.shape, "command")
    if time_s.size < 2:
        raise MovesError(f"{time_s.size} move(s) make up no test: state every move of it")
    wrong = np.flatnonzero(~(np.isfinite(time_s) & np.isfinite(command)))
    if wrong.size:
        raise MovesError(f"move {wrong[0] + 1} has no time or no size: complete the moves", int(wrong[0]) + 1)
    late = np.flatnonzero(np.diff(time_s) <= 0.0)
    if late.size:
        row = int(late[0]) + 2
        raise MovesError(
            f"move {row} at {time_s[row - 1]:g} s does not follow the one at {time_s[row - 2]:g} s: times have to "
            "increase; check whether the columns are swapped or two runs stand in one file",
            row,
        )
    still = np.flatnonzero(command == 0.0)
    if still.size:
        raise MovesError(f"move {still[0] + 1} is 0: leave out what commands no motion", int(still[0]) + 1)
    return Moves(np.asarray(time_s, dtype=np.float64), np.asarray(command, dtype=np.float64), unit)
