"""A beam with counters that look along it, whatever it measures."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping

import numpy as np

from catseye.simulators.config import EmulationConfig
from catseye.simulators.errors import BenchError
from catseye.simulators.world.beam_path import BeamPath
from catseye.simulators.world.counter import Counter, Gap, Reading, gaps_between
from catseye.simulators.world.mount import Screw
from catseye.simulators.world.optics import NOBODY, Sight
from catseye.simulators.world.types import Floats

_REST_STEP_S = 10.0
"""While nothing moves only warming changes the beam; it is looked at this often."""


class BeamSampling:
    """Times of looks: those that a motion asks for, and after its end one now and then.

    Args:
        times_s: of a motion that is over, bench times in order, s, one at least, shape (n,).
    """

    def __init__(self, times_s: Floats) -> None:
        self._times_s = times_s
        self._taken = times_s.size

    def plan(self, times_s: Floats, now_s: float) -> None:
        """Take the times that the present motion asks for; what lies before the present moment is over.

        Args:
            times_s: bench times in order, s, one at least, shape (n,).
            now_s: bench time.
        """
        self._times_s = times_s
        self._taken = int(np.searchsorted(times_s, now_s, side="right"))

    def due(self, now_s: float, until_s: float) -> Floats:
        """Return the times of looks after the present and up to a moment, in order, and take them as done."""
        upto = int(np.searchsorted(self._times_s, until_s, side="right"))
        due = self._times_s[self._taken : upto]
        self._taken = max(self._taken, upto)
        calm_s = float(self._times_s[-1])
        first = int(np.floor(max(0.0, now_s - calm_s) / _REST_STEP_S)) + 1
        last = int(np.floor(max(0.0, until_s - calm_s) / _REST_STEP_S))
        if last < first:
            return due
        return np.concatenate([due, calm_s + _REST_STEP_S * np.arange(first, last + 1)])


class CountedBeam(ABC):
    """A beam; it is looked at on times fixed by each motion, and whenever somebody asks.

    Args:
        config: budget and seed of the counters, and how fast they follow.
        index_at: refractive index of the air at a bench time, s.
        now: bench time, s.
        path: of the beam.

    Attributes:
        largest_miss_mm: largest miss since a counter was zeroed last, mm.
    """

    def __init__(
        self,
        config: EmulationConfig,
        index_at: Callable[[float], float],
        now: Callable[[], float],
        path: BeamPath,
    ) -> None:
        self._config = config
        self._index_at = index_at
        self._now = now
        self._path = path
        self._counter = Counter(config, self.look(np.zeros(1)), index_at)
        self._instruments: list[Counter] = []
        self._sampling = BeamSampling(self._sample_times())
        self.largest_miss_mm = 0.0

    @abstractmethod
    def look(self, times_s: Floats) -> Sight:
        """Return what the beam meets at bench times, s, shape (n,); no counter notices."""

    @abstractmethod
    def level(self, miss_mm: float) -> float:
        """Return the signal level, 0...1, of a beam that returns with a miss."""

    @property
    @abstractmethod
    def screws(self) -> Mapping[str, Screw]:
        """Screws of the mount by name."""

    @abstractmethod
    def _turn(self, screw: str, turns: float) -> None:
        """Turn one of the screws, clockwise positive."""

    @abstractmethod
    def _sample_times(self) -> Floats:
        """Return the bench times at which the present motion asks for looks, s, in order, one at least."""

    @property
    def length_mm(self) -> float:
        """True length of the beam at this moment, mm."""
        return float(self.look(np.array([self._now()])).length_mm[0])

    def observe(self) -> Sight:
        """Let the counters see what the beam meets now."""
        sight = self.look(np.array([self._now()]))
        self._follow(sight)
        return sight

    def observe_until(self, time_s: float) -> None:
        """Let the counters see what they have to on the way to a moment of bench time, s."""
        due = self._sampling.due(self._now(), time_s)
        if due.size:
            self._follow(self.look(due))

    def plan_looks(self) -> None:
        """Take over the times of looks that the arm's present motion asks for."""
        self._sampling.plan(self._sample_times(), self._now())

    def new_counter(self) -> Counter:
        """Return a further length counter, with zero, latches and noise of its own."""
        counter = Counter(self._config, self.observe().last(), self._index_at, number=len(self._instruments))
        counter.set_laser(ready=self.laser_ready)
        self._instruments.append(counter)
        return counter

    def read(self, counter: Counter | None = None) -> Reading:
        """Return one reading at this moment.

        Args:
            counter: which one; by default the bench's own, which no emulated instrument wears.
        """
        sight = self.observe()
        level = self.level(float(sight.miss_mm[0]))
        return (counter or self._counter).read(self._now(), level)

    def zero(self, counter: Counter | None = None) -> bool:
        """Zero a counter, by default the bench's own; False when it refuses because no beam returns."""
        self.observe()
        self.largest_miss_mm = 0.0
        return (counter or self._counter).zero(self._now())

    def restart(self, counter: Counter) -> None:
        """Let a counter count from 0 as after power on."""
        self.observe()
        counter.restart(self._now())

    def rate_mm_s(self, since_s: float, until_s: float) -> float:
        """Return the displacement rate between two bench times, mm/s; 0 without a beam."""
        before, after = (self.look(np.array([t])) for t in (since_s, until_s))
        if after.index[0] == NOBODY or before.index[0] != after.index[0] or since_s == until_s:
            return 0.0
        return float(after.length_mm[0] - before.length_mm[0]) / (until_s - since_s)

    def turn_screw(self, screw: str, turns: float) -> None:
        """Turn a screw of the mount; the counters count what the beam's length changes by.

        Args:
            screw: its name.
            turns: clockwise positive.

        Raises:
            BenchError: there is no such screw.
        """
        if screw not in self.screws:
            raise BenchError(f"there is no screw {screw!r}; there are {', '.join(self.screws)}")
        self.observe()
        self._turn(screw, turns)
        self._shift_target()

    @property
    def lost(self) -> bool:
        """The latch of the bench's own counter."""
        return self._counter.beam_lost

    def block(self, duration_s: float | None) -> None:
        """Hold something into the beam, for a time in s or until it is taken away."""
        until_s = np.inf if duration_s is None else self._now() + duration_s
        self._path.block(self._now(), until_s)
        self.observe()

    def unblock(self) -> None:
        """Take away what stands in the beam."""
        self.observe()
        self._path.block(np.inf, np.inf)
        self.observe()

    def weaken(self, factor: float) -> None:
        """Let dirt leave a part of the signal, 0...1 of the clean one."""
        self.observe()
        self._path.clearness = factor
        self.observe()

    def outrun_counters(self) -> None:
        """Let all counters lose count as after too fast a motion.

        Raises:
            BenchError: no beam returns, so nothing is counted.
        """
        if self.observe().index[0] == NOBODY:
            raise BenchError("no beam returns: there is no count to lose; aim at a reflector first")
        for counter in self._counters():
            counter.outrun()

    def set_laser(self, *, ready: bool) -> None:
        """Let the laser of all counters hold its frequency, or lose it."""
        self.observe()
        for counter in self._counters():
            counter.set_laser(ready=ready)

    @property
    def laser_ready(self) -> bool:
        """The laser holds its frequency."""
        return self._counter.laser_ready

    def _counters(self) -> tuple[Counter, ...]:
        return (self._counter, *self._instruments)

    def _shift_target(self) -> None:
        """Go on counting after a hand changed the beam or its target."""
        sight = self.look(np.array([self._now()]))
        # A push by hand is counted, for it takes time; a jump to another reflector or to none is not.
        jumped = int(sight.index[0]) != int(self._counter.last.index[0])
        gaps = self._gaps(sight) if jumped else []
        for counter in self._counters():
            counter.follow(gaps, sight)

    def _follow(self, sight: Sight) -> None:
        self.largest_miss_mm = max(self.largest_miss_mm, float(sight.miss_mm.max()))
        gaps, last = self._gaps(sight), sight.last()
        for counter in self._counters():
            counter.follow(gaps, last)

    def _gaps(self, sight: Sight) -> list[Gap]:
        """Return what no counter counts from the last look to some looks: all of them have seen the same."""
        return gaps_between(self._counter.last, sight, self._config.speed_limit_mm_s, self._index_at)
