"""uMD displays: a stream of samples without commands (sheet `interferometers`, section 5).

A sample is taken at its exact bench time and numbered; samples that are due together leave together, as over USB, and
none is left out. The bench may run faster than real time: the stream then keeps its rate in real time, since a client
could not take more.

Not known, and assumed here: which of the 32 places carries which LOWCODE; that the phase is the fraction above the
count; that the count goes on from a wrong place after a break. Where LOWCODE is 0, LOWDATA has no meaning: here it is
0x454D554C, the letters EMUL.
"""

from collections import deque
from collections.abc import Callable
from math import floor
from typing import Literal

from pydantic import Field

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import Emulator, NewSession, Note
from catseye.simulators.lengths import LengthOptions, Lengths
from catseye.simulators.ports.session import Answer, Session
from catseye.simulators.world.air_probe import AirProbe
from catseye.simulators.world.instrument import Instrument
from catseye.simulators.world.timekeeper import TimeKeeper

MARK = 0x454D554C
FIRMWARE = 100

MOST_LINES = 20_000
"""So many samples are kept for a client that does not take them; the oldest go first."""
_NO_AXIS = "0 0 0 0"
_REFERENCE = 1500


class UmdOptions(LengthOptions):
    """How this display is.

    Attributes:
        rate_hz: samples a second: 610.35 of a uMD1, 1000 of a uMD2.
        vacuum_wavelength_nm: of the laser, nm.
        multiplier: of the optics.
        axes: in a line; the first looks at the bench, the others see nothing.
    """

    rate_hz: float = Field(default=610.35, gt=0.0)
    vacuum_wavelength_nm: float = Field(default=632.9908, gt=0.0)
    multiplier: Literal[1, 2, 4] = 1
    axes: Literal[1, 3] = 1


class Umd:
    """The display that all clients share. It samples while somebody listens."""

    def __init__(
        self, instrument: Instrument, probe: AirProbe, keeper: TimeKeeper, options: UmdOptions
    ) -> None:
        self.bench = instrument.bench
        self._instrument = instrument
        self._probe = probe
        self._keeper = keeper
        self._options = options
        self._lengths = Lengths(sign=options.sign)
        self._counts_per_mm = 2e6 * options.multiplier / options.vacuum_wavelength_nm
        self._listeners: list[Callable[[bytes], None]] = []
        self._sequence = 0
        self._last_counts = 0.0
        self._running = False
        self.next_s = 0.0

    def join(self, listener: Callable[[bytes], None]) -> None:
        """Call a listener with every line from now on."""
        # Bench time may stand where the last one asked: what was sampled until now went to nobody.
        self._keeper.sync()
        self._listeners.append(listener)
        if not self._running:
            self._running = True
            # The display has gone on counting its samples while nobody listened.
            missed = max(0, floor((self.bench.time_s - self.next_s) / self._period_s()))
            self._sequence += missed
            self._plan(max(self.bench.time_s, self.next_s + missed * self._period_s()))

    def leave(self, listener: Callable[[bytes], None]) -> None:
        """Call a listener no longer."""
        self._listeners.remove(listener)

    def _period_s(self) -> float:
        return max(1.0, self._keeper.speed) / self._options.rate_hz

    def _plan(self, time_s: float) -> None:
        self.next_s = time_s
        self.bench.call_at(time_s, self._sample)

    def _sample(self) -> None:
        if not self._listeners:
            self._running = False
            return
        line = self._line()
        self._sequence += 1
        self._plan(self.next_s + self._period_s())
        for listener in self._listeners:
            listener(line)

    def _line(self) -> bytes:
        reading = self._instrument.read()
        counts = self._lengths.shown_mm(reading) * self._counts_per_mm
        velocity = round(counts - self._last_counts) if reading.counts else 0
        self._last_counts = counts
        measured = max(1, _REFERENCE + velocity) if reading.counts else 0
        whole = floor(counts)
        phase = floor((counts - whole) * 256.0)
        code, data = self._low()
        others = f" {_NO_AXIS}" * (2 if self._options.axes == 3 else 0)
        line = (
            f"{_REFERENCE} {measured} {whole} {velocity} {phase} {self._sequence} {code} {data}{others}\r\n"
        )
        return line.encode("ascii")

    def _low(self) -> tuple[int, int]:
        """Return LOWCODE and LOWDATA of the present sample."""
        place = self._sequence & 0x1F
        if place == 0:
            return 10, FIRMWARE
        if place == 1:
            return 8, round(100.0 * self._options.rate_hz)
        air = self._probe.sample() if place in {2, 3, 4} else None
        if air is None:
            return 0, MARK
        values = {
            2: (3, air.temperature_c * 100),
            3: (5, air.pressure_hpa * 100),
            4: (6, air.humidity_percent),
        }
        code, value = values[place]
        return code, round(value)


class UmdSession(Session):
    """What one client hears."""

    def __init__(self, umd: Umd) -> None:
        self._umd = umd
        self._lines: deque[bytes] = deque(maxlen=MOST_LINES)
        self._listener = self._lines.append
        umd.join(self._listener)

    def feed(self, data: bytes) -> None:
        """Ignore what a client sends: there are no commands."""

    def answer(self) -> Answer | None:
        """Return None: there are no commands to answer."""
        return None

    def next_output_s(self) -> float | None:
        """Return when the next sample is due."""
        return self._umd.bench.time_s if self._lines else self._umd.next_s

    def output(self) -> bytes:
        """Return the samples taken since the last time."""
        said = b"".join(self._lines)
        self._lines.clear()
        return said

    def close(self) -> None:
        """Listen no longer."""
        self._umd.leave(self._listener)


class UmdDisplay(Emulator):
    """A display that all its clients share."""

    role = "interferometer"
    Options = UmdOptions

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make the display that all clients share."""
        del note
        options = cls.Options.of(device)
        umd = Umd(context.instrument(device.name), context.air.of(device.name), context.keeper, options)
        return lambda: UmdSession(umd)
