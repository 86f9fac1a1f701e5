"""Where the time of a run goes, and when the run will be over."""

from dataclasses import dataclass
from typing import Final

from catseye.drivers.roles.clock import Clock


@dataclass
class StepTime:
    """Time of one step, in seconds of the run's clock.

    Attributes:
        step_id: which step.
        start_s: when it began.
        total_s: from its beginning to its commit.
        motion_s: inside motions of the robot.
        idle_s: settling, and from the first to the last reading of a dwell.
        points: rows recorded into "points".
    """

    step_id: str
    start_s: float
    total_s: float = 0.0
    motion_s: float = 0.0
    idle_s: float = 0.0
    points: int = 0

    @property
    def software_s(self) -> float:
        """What the program and the links added to motion and waiting."""
        return self.total_s - self.motion_s - self.idle_s


_TRUSTED: Final = 0.25
"""The rehearsal counts as so much of its own time seen at its own pace: one slow step says little of all others."""

JUMP: Final = 0.05
"""An estimate of the whole that changes by more, from one word to the next, says why."""


@dataclass(frozen=True)
class TimeLeft:
    """How far a run is in time.

    Attributes:
        elapsed_bench_s: so far, waits left out.
        left_bench_s: estimate of the rest, without waits to come.
        elapsed_s: real time since the beginning, waits included.
        left_s: real time of the rest, without waits to come.
        changed: why the estimate of the whole is another one than before; empty while it is about the same.
    """

    elapsed_bench_s: float
    left_bench_s: float
    elapsed_s: float
    left_s: float
    changed: str = ""


@dataclass(frozen=True)
class _Word:
    done_s: float
    total_s: float
    worked_s: float
    left_s: float


class Progress:
    """Estimates the time left from expected bench seconds, corrected by the run's own pace.

    Args:
        speed: bench seconds in one real second.
    """

    def __init__(self, clock: Clock, speed: float = 1.0) -> None:
        self._clock = clock
        self._speed = speed
        self._start_s = clock.monotonic_s()
        self._first: _Word | None = None
        self._last: _Word | None = None

    def estimate(self, done_s: float, total_s: float, waited_s: float = 0.0) -> TimeLeft:
        """Return elapsed time and time left.

        Steps that were done before a resumption took no time now, so the pace counts from the first call. Waiting
        for people says nothing about the pace.

        Args:
            done_s: expected seconds of what is done.
            total_s: expected seconds of everything.
            waited_s: of the elapsed time, held, suspended or with a question open.
        """
        passed_s = self._clock.monotonic_s() - self._start_s
        worked_s, expected_left_s = passed_s - waited_s, max(0.0, total_s - done_s)
        if self._first is None:
            self._first = _Word(done_s, total_s, worked_s, expected_left_s)
        left_s = expected_left_s * self._pace(self._first, done_s, worked_s)
        word = _Word(done_s, total_s, worked_s, left_s)
        changed = "" if self._last is None else _changed(self._last, word)
        self._last = word
        return TimeLeft(worked_s, left_s, passed_s / self._speed, left_s / self._speed, changed)

    @staticmethod
    def _pace(first: _Word, done_s: float, worked_s: float) -> float:
        """Return the seconds that an expected second takes, by the rehearsal and by what was seen."""
        trusted_s = _TRUSTED * first.left_s
        expected_s = max(0.0, done_s - first.done_s) + trusted_s
        return (worked_s - first.worked_s + trusted_s) / expected_s if expected_s > 0.0 else 1.0


def _changed(last: _Word, word: _Word) -> str:
    """Return why the estimate of the whole has changed by more than a little; empty where it has not."""
    whole_s = last.worked_s + last.left_s
    if abs(word.worked_s + word.left_s - whole_s) <= JUMP * whole_s:
        return ""
    more_s = word.total_s - last.total_s
    over_s = (word.worked_s - last.worked_s) - (word.done_s - last.done_s)
    if abs(more_s) >= abs(over_s):
        return f"{abs(more_s):.0f} s {'more' if more_s > 0.0 else 'less'} to do than before"
    return f"this part took {abs(over_s):.0f} s {'more' if over_s > 0.0 else 'less'} than expected"
