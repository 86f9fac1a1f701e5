"""The length counter of an emulated interferometer, on whatever bench has a beam."""

from collections.abc import Callable
from typing import Protocol

from catseye.simulators.world.counted_beam import CountedBeam
from catseye.simulators.world.counter import Reading


class BeamBench(Protocol):
    """A bench with a beam, as its instruments see it."""

    @property
    def time_s(self) -> float:
        """Bench time, s."""
        ...

    @property
    def beam(self) -> CountedBeam:
        """What the instruments look along."""
        ...

    def call_at(self, time_s: float, action: Callable[[], None]) -> None:
        """Have something done at a moment of bench time, before anything later happens."""
        ...

    def velocity_mm_s(self) -> float:
        """Return the displacement rate at this moment, mm/s; 0 without a beam."""
        ...

    def air_index(self) -> float:
        """Return the refractive index of the air for a helium-neon laser at this moment."""
        ...


class Instrument:
    """One emulated instrument's length counter; several look along the same beam."""

    def __init__(self, bench: BeamBench) -> None:
        self.bench = bench
        self._counter = bench.beam.new_counter()

    @property
    def beam_lost(self) -> bool:
        """The latch of this instrument."""
        return self._counter.beam_lost

    @property
    def break_count(self) -> int:
        """Breaks of the beam so far."""
        return self._counter.break_count

    @property
    def overspeed_count(self) -> int:
        """How often the beam's length changed too fast so far."""
        return self._counter.overspeed_count

    def read(self) -> Reading:
        """Return one reading at this moment."""
        return self.bench.beam.read(self._counter)

    def zero(self) -> bool:
        """Zero the count; False when it refuses because no beam returns."""
        return self.bench.beam.zero(self._counter)
