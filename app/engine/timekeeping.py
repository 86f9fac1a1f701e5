"""Where the time of a run goes, and when the run will be over."""

from dataclasses import dataclass

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


class Progress:
    """Estimates the time left from expected bench seconds, corrected by the run's own pace."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._start_s = clock.monotonic_s()
        self._first: tuple[float, float] | None = None

    def estimate(self, done_s: float, total_s: float, waited_s: float = 0.0) -> tuple[float, float]:
        """Return elapsed and remaining time, s.

        Steps that were done before a resumption took no time now, so the pace counts from the first call. Waiting
        for people says nothing about the pace.

        Args:
            done_s: expected seconds of what is done.
            total_s: expected seconds of everything.
            waited_s: of the elapsed time, held, suspended or with a question open.
        """
        elapsed_s = self._clock.monotonic_s() - self._start_s
        if self._first is None:
            self._first = (done_s, elapsed_s - waited_s)
        expected_s, taken_s = done_s - self._first[0], elapsed_s - waited_s - self._first[1]
        pace = taken_s / expected_s if expected_s > 0.0 else 1.0
        return elapsed_s, max(0.0, total_s - done_s) * pace
