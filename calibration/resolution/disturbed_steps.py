"""Single steps that something disturbed: they lie many scatters off what all others of the series say of them.

A joint that sticks once and makes two steps at the next command, or a knock at the bench, is no part of the mean
error, but pulls a mean over eleven steps by a tenth of its size. Only what stands alone is left out: where a joint
sticks time and again, that is what the joint does.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.resolution.flags import Flag, flag_moves
from catseye.calibration.resolution.least_step import WINDOW
from catseye.calibration.resolution.mean_curve import off_the_others

_FAR: Final = 5.0
"""Standard deviations off the others: chance makes such a step in one of ten thousand series."""

_FAR_PERCENT: Final = 5.0
"""A step closer than this to what others say of it moves the moving mean by half a per cent at most."""

_MOST_SHARE: Final = 0.1
"""Where more of the steps lie far off, they are the scatter."""


@dataclass(frozen=True)
class DisturbedSteps:
    """Steps that lie far off the others.

    Attributes:
        single: those that stand alone, shape (n,).
        paired: steps that were not made in full with the one behind them that made up for it, alone too, shape (n,).
        repeated: those with others within the moving mean's window: these count as what the joint does, shape (n,).
    """

    single: Bools
    paired: Bools
    repeated: Bools

    @property
    def left_out(self) -> Bools:
        """What a mean curve does not have to agree with, shape (n,)."""
        return np.asarray(self.single | self.paired)

    def flags(self, numbers: Ints, first: int) -> list[Flag]:
        """Return what a reader has to know of them.

        Args:
            numbers: place of each step among the moves, from 0, shape (n,).
            first: number of the first move.
        """
        texts = (
            (
                self.single,
                f"lies {_FAR:g} standard deviations or more off its neighbours: left out of the mean error, and the "
                "interval holds what the rule gives with it, too; look at the recording there, or measure again",
            ),
            (
                self.paired,
                "not made in full, and the next one made up for it: together they are right, so the joint stuck "
                "once; left out of the mean error, and the interval holds what the rule gives with them, too",
            ),
            (
                self.repeated,
                f"lie {_FAR:g} standard deviations or more off the others, within {WINDOW} steps of one another: "
                "they count as what the joint does; look at the recording there, or measure again",
            ),
        )
        concerned = np.zeros(int(numbers.max()) + 1, dtype=np.bool_)
        flags: list[Flag] = []
        for which, text in texts:
            concerned[numbers] = which
            flags += flag_moves("disturbed", concerned, text, first)
        return flags


def disturbed_steps(size: Floats, error_percent: Floats) -> DisturbedSteps:
    """Return which steps of a series lie far off what all others say of them.

    Args:
        size: commanded, decreasing, shape (n,).
        error_percent: E_s of each, shape (n,).
    """
    far, off, scatter = _far(np.log(size), error_percent)
    found = DisturbedSteps(*(np.zeros(size.size, dtype=np.bool_) for _ in range(3)))
    places = np.flatnonzero(far)
    for group in np.split(places, np.flatnonzero(np.diff(places) >= WINDOW) + 1):
        kind = found.repeated
        if group.size == 1:
            kind = found.single
        elif group.size == 2 and _made_up(off[group] * size[group], scatter[group] * size[group], group):
            kind = found.paired
        kind[group] = True
    return found


def _far(log_step: Floats, error_percent: Floats) -> tuple[Bools, Floats, Floats]:
    """Return which steps lie far off, how far each does, and one standard deviation of that, %, shape (n,) each.

    One by one, the farthest first: a step that is far off draws its neighbours' mean with it.
    """
    counted = np.ones(error_percent.size, dtype=np.bool_)
    off, deviations = off_the_others(log_step, error_percent, counted)
    for _ in range(int(_MOST_SHARE * counted.size)):
        beyond = (np.abs(deviations) > _FAR) & (np.abs(off) > _FAR_PERCENT) & counted
        if not beyond.any():
            return ~counted, off, np.asarray(off / deviations)
        counted[np.argmax(np.where(beyond, np.abs(deviations), 0.0))] = False
        off, deviations = off_the_others(log_step, error_percent, counted)
    return np.zeros_like(counted), off, np.asarray(off / deviations)


def _made_up(off: Floats, scatter: Floats, places: Ints) -> bool:
    """Return whether a step is too small by what the next one is too large, within their scatter."""
    return bool(places[1] == places[0] + 1 and off[0] < 0.0 and abs(off.sum()) < _FAR * np.hypot(*scatter))
