"""The laser beam: what it meets, and the counters that look along it."""

from collections.abc import Callable

import numpy as np

from catseye.simulators.config import EmulationConfig
from catseye.simulators.errors import BenchError
from catseye.simulators.world.arm import Arm
from catseye.simulators.world.counter import Counter, Gap, Reading, gaps_between
from catseye.simulators.world.mount import Mount
from catseye.simulators.world.optics import NOBODY, Optics, Reflectors, Sight
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


class Beam:
    """The beam on its arm; it is looked at on times fixed by each motion, and whenever somebody asks.

    Args:
        index_at: refractive index of the air at a bench time, s.
        now: bench time, s.

    Attributes:
        largest_miss_mm: largest distance from a reflector since a counter was zeroed last, mm.
    """

    def __init__(
        self,
        arm: Arm,
        reflectors: Reflectors,
        config: EmulationConfig,
        index_at: Callable[[float], float],
        now: Callable[[], float],
    ) -> None:
        self._arm = arm
        self._config = config
        self._index_at = index_at
        self._now = now
        self._optics = Optics(reflectors, config, float(arm.poses(np.zeros(1)).height_mm[0]))
        self._counter = Counter(config, self.look(np.zeros(1)), index_at)
        self._instruments: list[Counter] = []
        self._sampling = BeamSampling(arm.sample_times())
        self.largest_miss_mm = 0.0

    def look(self, times_s: Floats) -> Sight:
        """Return what the beam meets at bench times, s, shape (n,); no counter notices."""
        return self._optics.look(self._arm.poses(times_s))

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
        self._sampling.plan(self._arm.sample_times(), self._now())

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
        level = self._optics.level(float(sight.miss_mm[0]))
        return (counter or self._counter).read(self._now(), level)

    def zero(self, counter: Counter | None = None) -> bool:
        """Zero a counter, by default the bench's own; False when it refuses because no beam returns."""
        self.observe()
        self.largest_miss_mm = 0.0
        return (counter or self._counter).zero(self._now())

    def rate_mm_s(self, since_s: float, until_s: float) -> float:
        """Return the displacement rate between two bench times, mm/s; 0 without a beam."""
        before, after = (self.look(np.array([t])) for t in (since_s, until_s))
        if after.index[0] == NOBODY or before.index[0] != after.index[0] or since_s == until_s:
            return 0.0
        return float(after.length_mm[0] - before.length_mm[0]) / (until_s - since_s)

    @property
    def lost(self) -> bool:
        """The latch of the bench's own counter."""
        return self._counter.beam_lost

    def name_of(self, place: int) -> str:
        """Return the name of a reflector by its place in a sight."""
        return self._optics.names[place]

    def block(self, duration_s: float | None) -> None:
        """Hold something into the beam, for a time in s or until it is taken away."""
        until_s = np.inf if duration_s is None else self._now() + duration_s
        self._optics.block(self._now(), until_s)
        self.observe()

    def unblock(self) -> None:
        """Take away what stands in the beam."""
        self.observe()
        self._optics.block(np.inf, np.inf)
        self.observe()

    def move_reflector(self, name: str, dx_mm: float, dy_mm: float) -> None:
        """Shift a reflector; the counter counts what it sees of it.

        Raises:
            BenchError: there is no such reflector.
        """
        self._require_nest(name)
        self.observe()
        self._optics.move_reflector(name, complex(dx_mm, dy_mm))
        self._shift_target()

    def place_reflector(self, name: str) -> None:
        """Put the reflector into a nest and leave all others empty, or fill them all.

        Args:
            name: of the nest, or "all".

        Raises:
            BenchError: there is no such nest.
        """
        names = self._optics.names if name == "all" else [name]
        if name != "all":
            self._require_nest(name)
        self.observe()
        self._optics.remove_all_but(names)
        self.observe()
        self._optics.put(names)
        self.observe()

    @property
    def in_place(self) -> list[str]:
        """Names of the nests with a reflector in them."""
        return self._optics.in_place

    @property
    def mount(self) -> Mount:
        """How the beam lies on the arm."""
        return self._optics.mount

    def remount(self, turned_deg: float) -> None:
        """Take the interferometer off the arm and mount it turned; nothing is counted meanwhile.

        Args:
            turned_deg: angle about the last axis against the first mounting.
        """
        self.observe()
        with self._optics.in_hand():
            self.observe()
            self.mount.remount(turned_deg)
        self.observe()

    def turn_screw(self, screw: str, turns: float) -> None:
        """Turn a screw of the mount; the counter counts what the beam's length changes by.

        Args:
            screw: "stage" or "level".
            turns: clockwise positive.

        Raises:
            BenchError: there is no such screw.
        """
        if screw not in self.mount.screws:
            raise BenchError(f"there is no screw {screw!r}; there are {', '.join(self.mount.screws)}")
        self.observe()
        self.mount.turn(screw, turns)
        self._shift_target()

    def weaken(self, factor: float) -> None:
        """Let dirt leave a part of the signal, 0...1 of the clean one."""
        self.observe()
        self._optics.clearness = factor
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

    def _require_nest(self, name: str) -> None:
        if name not in self._optics.names:
            known = ", ".join(self._optics.names)
            raise BenchError(f"there is no reflector {name!r}; there are {known}")

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
