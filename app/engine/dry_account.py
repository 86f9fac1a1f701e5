"""The account of a rehearsal: motions, measurements and the time they take, and recordings that keep nothing."""

from dataclasses import dataclass

from catseye.app.engine.driven import AT_REST, Speeds
from catseye.procedures.kit.recording import Recording


@dataclass
class Account:
    """What was done so far, and the peaks since the step began."""

    moves: int = 0
    measurements: int = 0
    time_s: float = 0.0
    speeds: Speeds = AT_REST
    miss_mm: float | None = None


@dataclass(frozen=True)
class IdealRecording(Recording):
    """A recording that keeps nothing.

    Attributes:
        title: its name.
        origin_s: expected time of its beginning.
        rate_hz: at which readings come.
        account: of the expected time.
    """

    title: str
    origin_s: float
    rate_hz: float
    account: Account

    @property
    def name(self) -> str:
        """Its title."""
        return self.title

    @property
    def readings(self) -> int:
        """How many have come by the expected time."""
        return int(self.elapsed_s * self.rate_hz) + 1

    @property
    def elapsed_s(self) -> float:
        """Expected time since its beginning, s."""
        return self.at(self.account.time_s)

    def at(self, clock_s: float) -> float:
        """Return the time of the recording at an expected time."""
        return clock_s - self.origin_s

    def newest(self, count: int) -> list[tuple[float, float]]:
        """Return nothing: no reading is kept."""
        del count
        return []
