"""The drift at the reference pose of a warm-up, as the visits show it."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.calibration.core.settling import DriftRate, drift_rate, settling
from catseye.calibration.core.types import Floats
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import integer, number, number_of
from catseye.procedures.scara.warming.warmup_plan import WarmupPlan

_COMPLETE = 0.95
"""Visits of a full window span this share of it: the next one would lie beyond it."""

FEWEST_VISITS = 6
"""Visits that a drift comes from at least, however long they took."""

_MOST_OVERRUN: Final = 2.0
"""Of the longest time, for the visits without which there is no verdict."""

_REST = 3.0
"""Who was waited for so many times longer than a visit is planned has let the arm cool."""


def rate_over(time_s: Floats, length_mm: Floats, window_s: float) -> DriftRate | None:
    """Return the drift over a window that ends with the last visit; None while visits do not fill it.

    Args:
        time_s: times of the visits, s, shape (n,).
        length_mm: distances that share a zero, mm, shape (n,).
        window_s: length of the window.
    """
    last = time_s[-1]
    recent = max(int(np.count_nonzero(time_s >= last - window_s)), FEWEST_VISITS)
    if last - time_s[0] < _COMPLETE * window_s or time_s.size < FEWEST_VISITS:
        return None
    return drift_rate(time_s[-recent:], length_mm[-recent:])


@dataclass(frozen=True)
class _Seen:
    time_s: float
    waited_s: float
    displacement_mm: float


class Watch:
    """The drift as the visits show it; a new segment begins a new series."""

    def __init__(self, plan: WarmupPlan) -> None:
        self._plan = plan
        self._segment: int | None = None
        self._series: list[_Seen] = []
        self._below = 0
        self._taken = 0
        self.elapsed_s = 0.0
        self.rate: DriftRate | None = None

    @property
    def warm(self) -> bool:
        """The drift was below the limit often enough."""
        return self._below >= self._plan.checks

    @property
    def below(self) -> int:
        """Visits in a row, the last one included, at which the drift was below the limit."""
        return self._below

    @property
    def is_late(self) -> bool:
        """The longest time is over, without as many visits as a verdict needs: they take longer than planned."""
        return self.elapsed_s >= self._plan.duration_limit_s and self._missing > 0

    @property
    def is_over(self) -> bool:
        """The longest time is over, and a verdict was possible in it; or it is over twice."""
        limit_s = self._plan.duration_limit_s
        return self.elapsed_s >= (limit_s if self._missing == 0 else _MOST_OVERRUN * limit_s)

    @property
    def visits(self) -> int:
        """Visits of the present series."""
        return len(self._series)

    def take(self, row: Row) -> bool:
        """Take a visit in; return whether it begins a new series after another one."""
        self._taken += 1
        if not row["measured"]:
            self.elapsed_s += self._plan.visit_s
            return False
        # Runs of before do not say who was waited for.
        waited_s = number(row.get("waited_s", 0.0))
        seen = _Seen(number_of(row, "clock_s"), waited_s, number_of(row, "displacement_mm"))
        segment = integer(row["segment"])
        begins = self._segment != segment or self._rested(seen)
        again = self._segment is not None and begins
        if begins:
            self._segment, self._series, self._below = segment, [], 0
        # Time between two processes of a run, or of a hold, is no exercise.
        self.elapsed_s += seen.time_s - self._series[-1].time_s if self._series else self._plan.visit_s
        self._series.append(seen)
        self._judge()
        return again

    def remaining_s(self) -> float:
        """Return how long it will take: until the longest time, or less where an exponential approach is seen."""
        longest = max(0.0, self._plan.duration_limit_s - self.elapsed_s, self._missing * self._usual_s)
        if self.visits < 2:
            return longest
        time_s, length_mm = self._columns(self._series)
        approach = settling(time_s, length_mm)
        if approach is None:
            return longest
        # A slope belongs to the middle of its window.
        end_s = approach.below_after_s(self._plan.limit_um_per_10min) + 0.5 * self._plan.window_s
        checks_s = (self._plan.checks - self._below) * self._plan.visit_s
        return min(longest, max(end_s - float(time_s[-1]), 0.0) + checks_s)

    @property
    def _missing(self) -> int:
        """Visits that a verdict needs at least, and that have not been made yet."""
        return max(0, FEWEST_VISITS + self._plan.checks - 1 - self._taken)

    @property
    def _usual_s(self) -> float:
        """How long a visit has taken so far."""
        return self.elapsed_s / self._taken if self._taken else self._plan.visit_s

    def _rested(self, seen: _Seen) -> bool:
        """Return whether the arm stood still for long before a visit: a hold, an open door, a question.

        A visit that takes long by itself is none: on a fast emulator a busy computer makes hours of seconds.
        """
        if not self._series:
            return False
        return seen.waited_s - self._series[-1].waited_s > _REST * self._plan.visit_s

    def _judge(self) -> None:
        self.rate = rate_over(*self._columns(self._series), self._plan.window_s)
        below = self.rate is not None and self.rate.bound_um_per_10min <= self._plan.limit_um_per_10min
        self._below = self._below + 1 if below else 0

    def _columns(self, series: list[_Seen]) -> tuple[Floats, Floats]:
        start = self._series[0].time_s
        return (
            np.array([seen.time_s - start for seen in series]),
            np.array([seen.displacement_mm for seen in series]),
        )
