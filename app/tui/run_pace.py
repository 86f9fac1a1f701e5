"""How far a run is between two words of its engine, and whether its end moves away."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.run_events import Progressed

_LITTLE_S: Final = 5.0
_LITTLE_SHARE: Final = 0.02
"""A total that grows by less than the larger of both has not grown."""


@dataclass
class RunPace:
    """Goes on with the estimate of the engine while the run does, and stands while it stands.

    Attributes:
        progress: last word of the engine; None before the first.
        stands_since_s: since when the run waits, monotonic s; None while it goes on.
    """

    progress: "Progressed | None" = None
    stands_since_s: float | None = None
    _at_s: float = 0.0
    _least_total_s: float | None = None

    def begin(self, now_s: float) -> None:
        """The run begins; until the first word of the engine its time is counted from here."""
        self._at_s = now_s

    def expect(self, total_s: float) -> None:
        """Take how long the whole run takes by its rehearsal, before the first word of the engine."""
        if self.progress is None:
            self._least_total_s = total_s

    def take(self, progress: "Progressed", now_s: float) -> None:
        """Take a word of the engine.

        Args:
            now_s: monotonic time of its arrival, s.
        """
        self.progress, self._at_s = progress, now_s
        total_s = progress.elapsed_bench_s + progress.left_bench_s
        self._least_total_s = total_s if self._least_total_s is None else min(self._least_total_s, total_s)
        if self.stands_since_s is not None:
            self.stands_since_s = now_s

    def stand(self, stands: bool, now_s: float) -> None:
        """Take note whether the run waits: for an answer, for a beam, while it is held."""
        if stands and self.stands_since_s is None:
            self.stands_since_s = now_s
        elif not stands and self.stands_since_s is not None:
            # Waits are no part of the estimate.
            self._at_s += max(now_s - max(self.stands_since_s, self._at_s), 0.0)
            self.stands_since_s = None

    def since_s(self, now_s: float, speed: float) -> float:
        """Return the bench time that has gone since the last word, waits left out, s.

        Args:
            speed: bench seconds in one real second.
        """
        until_s = now_s if self.stands_since_s is None else self.stands_since_s
        return speed * max(until_s - self._at_s, 0.0)

    @property
    def grown_s(self) -> float:
        """By how much the whole run takes longer than it once looked, s; 0 where that is little."""
        if self.progress is None or self._least_total_s is None:
            return 0.0
        grown_s = self.progress.elapsed_bench_s + self.progress.left_bench_s - self._least_total_s
        return grown_s if grown_s > max(_LITTLE_S, _LITTLE_SHARE * self._least_total_s) else 0.0
