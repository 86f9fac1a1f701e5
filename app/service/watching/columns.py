"""Samples folded into columns of equal duration: what a strip chart shows of any number of values a second."""

import math
from collections import deque
from dataclasses import dataclass, field

PERIOD_S = 0.02
"""Duration of a column, s."""

MOST_COLUMNS = 500
"""Columns that wait to be taken; older ones are dropped and counted."""

_SPREAD_COLUMNS = 50
_FEWEST_SAMPLES = 3


@dataclass
class _Column:
    """Extremes of the samples of one column, and their mean and sum of squared deviations (Welford)."""

    low: float = math.inf
    high: float = -math.inf
    count: int = 0
    mean: float = 0.0
    squares: float = 0.0

    def add(self, value: float) -> None:
        self.low = min(self.low, value)
        self.high = max(self.high, value)
        self.count += 1
        off = value - self.mean
        self.mean += off / self.count
        self.squares += off * (value - self.mean)


@dataclass(frozen=True)
class Taken:
    """Columns since the last ones were taken, oldest first.

    Attributes:
        low: smallest sample of each column; None where there is none.
        high: largest sample of each column; None where there is none.
        count: samples of each column.
        missed: older columns that were dropped.
    """

    low: list[float | None] = field(default_factory=list)
    high: list[float | None] = field(default_factory=list)
    count: list[int] = field(default_factory=list)
    missed: int = 0


class Columns:
    """Folds samples into columns; the caller gives the time.

    Args:
        period_s: duration of a column, s.
        most: columns that wait to be taken.
    """

    def __init__(self, period_s: float = PERIOD_S, most: int = MOST_COLUMNS) -> None:
        self.period_s = period_s
        self._most = most
        self._number: int | None = None
        self._open = _Column()
        self._done: deque[_Column] = deque()
        self._recent: deque[_Column] = deque(maxlen=_SPREAD_COLUMNS)
        self._missed = 0

    def add(self, value: float, time_s: float) -> None:
        """Add a sample taken at a time; times do not go back."""
        self._advance(time_s)
        self._open.add(value)

    def take(self, time_s: float) -> Taken:
        """Return the columns that are over at a time, and forget them."""
        self._advance(time_s)
        done, self._done = self._done, deque()
        missed, self._missed = self._missed, 0
        return Taken(
            [column.low if column.count else None for column in done],
            [column.high if column.count else None for column in done],
            [column.count for column in done],
            missed,
        )

    def mean(self) -> float | None:
        """Return the mean of the samples of the last second; None without one."""
        count, mean, _ = self._pooled()
        return mean if count else None

    def spread(self) -> float | None:
        """Return the standard deviation of the samples of the last second; None of fewer than three."""
        count, _, squares = self._pooled()
        return math.sqrt(squares / (count - 1)) if count >= _FEWEST_SAMPLES else None

    def _pooled(self) -> tuple[int, float, float]:
        """Return count, mean and sum of squared deviations of the samples of the last second."""
        count, mean, squares = 0, 0.0, 0.0
        for column in (*self._recent, self._open):
            if column.count:
                off = column.mean - mean
                both = count + column.count
                squares += column.squares + off * off * count * column.count / both
                mean += off * column.count / both
                count = both
        return count, mean, squares

    def _advance(self, time_s: float) -> None:
        """Close every column that is over."""
        number = math.floor(time_s / self.period_s)
        if self._number is None or number <= self._number:
            self._number = number if self._number is None else self._number
            return
        gap = number - self._number - 1
        self._number = number
        self._close(self._open)
        self._open = _Column()
        self._missed += max(0, gap - self._most)
        for _ in range(min(gap, self._most)):
            self._close(_Column())

    def _close(self, column: _Column) -> None:
        self._done.append(column)
        self._recent.append(column)
        if len(self._done) > self._most:
            self._done.popleft()
            self._missed += 1
