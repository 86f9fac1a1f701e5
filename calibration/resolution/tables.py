"""Look-up tables of step errors: by joint, direction, position and size of the step; beyond them they say nothing."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from catseye.calibration.core.arguments import (
    require_finite,
    require_increasing,
    require_not_negative,
    require_positive,
    require_shape,
)
from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Bools, Floats

TRAVEL = 1.0
"""deg or mm about its position that the steps of a test cover themselves: the paper's sum up to 1.5°."""

_ROUNDING = 1e-9
"""Part of a step that lies beyond a table by rounding only."""


@dataclass(frozen=True)
class ExpectedErrors:
    """Errors of steps at one position, relative to the step.

    Attributes:
        mean_percent: expected error, shape (n,).
        scatter_percent: standard deviation of a single step about it, shape (n,).
        u_mean_percent: standard uncertainty of the expected error, common to steps of similar size, shape (n,).
    """

    mean_percent: Floats
    scatter_percent: Floats
    u_mean_percent: Floats


@dataclass(frozen=True)
class Sector:
    """Step errors of a joint at one position.

    Attributes:
        position: of the joint, deg or mm.
        commands: sizes of steps, positive and increasing, deg or mm, shape (n,).
        errors: of these steps.
        reversal: lost motion at a reversal, deg or mm; None where it is not known.
    """

    position: float
    commands: Floats
    errors: ExpectedErrors
    reversal: float | None = None

    def __post_init__(self) -> None:
        where = f"the table at position {self.position:g}"
        require_finite(self.position, f"position of {where}")
        require_increasing(self.commands, f"commands of {where}")
        require_positive(self.commands, f"commands of {where}")
        for values, what, check in (
            (self.errors.mean_percent, "mean", require_finite),
            (self.errors.scatter_percent, "scatter", require_not_negative),
            (self.errors.u_mean_percent, "u of the mean", require_not_negative),
        ):
            require_shape(values, (self.commands.size,), f"{what} of {where}")
            check(values, f"{what} of {where}")
        if self.reversal is not None:
            require_not_negative(self.reversal, f"reversal of {where}")

    def at(self, sizes: Floats) -> Floats:
        """Return mean, scatter and u of the mean, linear in log(step), shape (3, n); only within its commands."""
        log, known = np.log(sizes), np.log(self.commands)
        errors = (self.errors.mean_percent, self.errors.scatter_percent, self.errors.u_mean_percent)
        return np.stack([np.interp(log, known, values) for values in errors])


@dataclass(frozen=True)
class Curve:
    """Step errors of a joint in one direction at a position between two sectors, or at one.

    Attributes:
        low: the sector below.
        high: the sector above; the same at a sector's own position.
        share: of the upper one, 0...1.
    """

    low: Sector
    high: Sector
    share: float

    @property
    def smallest(self) -> float:
        """Smallest step that both sectors know, deg or mm."""
        return float(max(self.low.commands[0], self.high.commands[0]))

    @property
    def largest(self) -> float:
        """Largest step that both sectors know, deg or mm."""
        return float(min(self.low.commands[-1], self.high.commands[-1]))

    @property
    def reversal(self) -> float | None:
        """Lost motion at a reversal, deg or mm; None where a sector does not know it."""
        if self.low.reversal is None or self.high.reversal is None:
            return None
        return (1.0 - self.share) * self.low.reversal + self.share * self.high.reversal

    def below(self, sizes: Floats) -> Bools:
        """Return which steps are smaller than the tables know."""
        return sizes < self.smallest * (1.0 - _ROUNDING)

    def above(self, sizes: Floats) -> Bools:
        """Return which steps are larger than the tables know."""
        return sizes > self.largest * (1.0 + _ROUNDING)

    def at(self, sizes: Floats) -> ExpectedErrors:
        """Return the errors of steps, NaN for those that the tables do not know.

        Args:
            sizes: magnitudes, deg or mm, shape (n,).
        """
        known = ~(self.below(sizes) | self.above(sizes))
        inside = np.where(known, sizes, self.smallest)
        values = (1.0 - self.share) * self.low.at(inside) + self.share * self.high.at(inside)
        return ExpectedErrors(*np.where(known, values, np.nan))


@dataclass(frozen=True)
class JointTable:
    """Step errors of a joint in one direction.

    Attributes:
        joint: its name.
        direction: 1 or -1.
        sectors: by increasing position.
    """

    joint: str
    direction: int
    sectors: tuple[Sector, ...]

    def __post_init__(self) -> None:
        what = f"positions of {self.joint} in direction {self.direction:+d}"
        require_increasing(np.array([sector.position for sector in self.sectors]), what)
        for low, high in pairwise(self.sectors):
            if low.commands[0] >= high.commands[-1] or high.commands[0] >= low.commands[-1]:
                raise ArgumentError(
                    f"{self.joint} in direction {self.direction:+d}: the tables at {low.position:g} and "
                    f"{high.position:g} have no step in common: give both the same series of steps"
                )

    def curve(self, position: float) -> Curve | None:
        """Return the errors at a position, interpolated between sectors; None outside of them.

        The sectors' steps have covered some of the way beyond the outermost ones (`TRAVEL`): those hold there.
        """
        places = [sector.position for sector in self.sectors]
        if not places[0] - TRAVEL <= position <= places[-1] + TRAVEL:
            return None
        number = int(np.searchsorted(places, position))
        if number in {0, len(places)}:
            outermost = self.sectors[min(number, len(places) - 1)]
            return Curve(outermost, outermost, 0.0)
        low, high = self.sectors[number - 1], self.sectors[number]
        return Curve(low, high, (position - low.position) / (high.position - low.position))


class ResolutionTables:
    """The tables of an arm's joints.

    Args:
        tables: one for each joint and direction.

    Raises:
        ArgumentError: there are two for the same.
    """

    def __init__(self, tables: Iterable[JointTable]) -> None:
        self.tables: Sequence[JointTable] = tuple(tables)
        self._of = {(table.joint, table.direction): table for table in self.tables}
        if len(self._of) < len(self.tables):
            raise ArgumentError("a joint has two tables for one direction: give one")

    def of(self, joint: str, direction: int) -> JointTable | None:
        """Return the table of a joint in one direction; None without one."""
        return self._of.get((joint, direction))
