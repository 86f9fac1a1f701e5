"""The length counter of an emulated interferometer."""

from catseye.simulators.world.counter import Reading
from catseye.simulators.world.timed_bench import TimedBench


class Instrument:
    """One emulated instrument's length counter; several look along the same beam."""

    def __init__(self, bench: TimedBench) -> None:
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

    def rate_mm_s(self) -> float:
        """Return the displacement rate that this instrument takes from its counts."""
        self.bench.beam.observe()
        return self._counter.rate_mm_s(self.bench.velocity_mm_s())

    def zero(self) -> bool:
        """Zero the count; False when it refuses because no beam returns."""
        return self.bench.beam.zero(self._counter)

    def restart(self) -> None:
        """Count from 0 as after power on."""
        self.bench.beam.restart(self._counter)
