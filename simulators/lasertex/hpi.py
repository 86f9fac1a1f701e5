"""Lasertex HPI-3D: acknowledged commands and streams of frames (sheet `interferometers`, section 2).

Known are the frames, their codes and the acknowledgement by a frame with the command's code. Not known, and assumed
here: flags stay set until their clear command or a zero; a command that is damaged or unknown is passed over; the
level runs from 0 to `signal_full_scale`; the lengths are not corrected for the air unless `compensated` says so. The
data of an acknowledgement have no known meaning: here they say EMULATOR.
"""

from collections import deque
from collections.abc import Callable

from pydantic import Field

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import Emulator, NewSession, Note
from catseye.simulators.lasertex import frames
from catseye.simulators.lengths import LengthOptions, Lengths
from catseye.simulators.ports.session import Answer, Session
from catseye.simulators.world.air_probe import AirProbe
from catseye.simulators.world.counter import Reading
from catseye.simulators.world.instrument import Instrument

LENGTH_PERIOD_S = 0.04
METEO_PERIOD_S = 1.0

_ACKNOWLEDGEMENT = b"EMULATOR"


class Hpi:
    """The instrument that all clients share.

    Args:
        full_scale: level of a full signal.
    """

    def __init__(
        self, instrument: Instrument, probe: AirProbe, lengths: Lengths, full_scale: int = 100
    ) -> None:
        self.instrument = instrument
        self._probe = probe
        self._lengths = lengths
        self._full_scale = full_scale
        self._breaks_cleared = instrument.break_count
        self._overspeeds_cleared = instrument.overspeed_count

    def zero(self) -> None:
        """Zero the count and clear the flags; without a beam the flag for a small signal comes back at once."""
        self.instrument.zero()
        self.clear_small_signal()
        self.clear_overspeed()

    def clear_small_signal(self) -> None:
        """Forget the breaks so far."""
        self.instrument.read()
        self._breaks_cleared = self.instrument.break_count

    def clear_overspeed(self) -> None:
        """Forget that the beam's length changed too fast."""
        self._overspeeds_cleared = self.instrument.overspeed_count

    def distance(self) -> bytes:
        """Return the length since the zero, with the flags, as a frame."""
        reading = self.instrument.read()
        return frames.distance(self._lengths.shown_mm(reading), **self._flags(reading))

    def velocity(self) -> bytes:
        """Return the rate of the length in mm/s, with the flags, as a frame."""
        reading = self.instrument.read()
        rate_mm_s = self._lengths.sign * self.instrument.rate_mm_s()
        return frames.velocity(rate_mm_s, **self._flags(reading))

    def meteo(self) -> bytes:
        """Return a frame of each sensor: air, and material as warm as the air; empty when they measure nothing."""
        air = self._probe.sample()
        if air is None:
            return b""
        return frames.meteo(0, air.temperature_c, air.humidity_percent, air.pressure_hpa) + frames.meteo(
            1, air.temperature_c
        )

    def _flags(self, reading: Reading) -> frames.Flags:
        return {
            "overspeed": self.instrument.overspeed_count > self._overspeeds_cleared,
            "laser_ready": reading.laser_ready,
            "signal_ok": reading.counts and self.instrument.break_count == self._breaks_cleared,
            "level": round(reading.level * self._full_scale),
        }


class HpiSession(Session):
    """Conversation with one client.

    Args:
        note: called with each command.
    """

    def __init__(self, hpi: Hpi, note: Callable[[str], None]) -> None:
        self._hpi = hpi
        self._note = note
        self._cutter = frames.CommandCutter()
        self._codes: deque[int] = deque()
        self._streams: dict[Callable[[], bytes], tuple[float, float]] = {}
        self._commands: dict[int, Callable[[], None]] = {
            0xB032: lambda: self._stream(hpi.distance, LENGTH_PERIOD_S, instead_of=hpi.velocity),
            0xB033: lambda: self._end(hpi.distance),
            0xB034: lambda: self._stream(hpi.velocity, LENGTH_PERIOD_S, instead_of=hpi.distance),
            0xB035: lambda: self._end(hpi.velocity),
            0xB03C: self._streams.clear,
            0xB03D: hpi.clear_small_signal,
            0xB03F: hpi.clear_overspeed,
            0xB040: lambda: None,
            0xB048: hpi.zero,
            0xB079: lambda: self._stream(hpi.meteo, METEO_PERIOD_S),
            0xB07A: lambda: self._end(hpi.meteo),
        }

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere."""
        self._codes += self._cutter.feed(data)

    def answer(self) -> Answer | None:
        """Carry out the next command."""
        if not self._codes:
            return None
        code = self._codes.popleft()
        self._note(f"{code:04X}")
        if code not in self._commands:
            return b""
        self._commands[code]()
        return frames.frame(code, _ACKNOWLEDGEMENT)

    def next_output_s(self) -> float | None:
        """Return when the next frame of a stream is due."""
        return min((due_s for due_s, _ in self._streams.values()), default=None)

    def output(self) -> bytes:
        """Return the frames that are due; of frames missed long ago only the last."""
        now_s = self._now_s()
        said = b""
        for make, (due_s, period_s) in self._streams.items():
            if due_s <= now_s:
                said += make()
                missed = (now_s - due_s) // period_s
                self._streams[make] = (due_s + (missed + 1.0) * period_s, period_s)
        return said

    def close(self) -> None:
        """End the streams."""
        self._streams.clear()

    def _now_s(self) -> float:
        return self._hpi.instrument.bench.time_s

    def _stream(
        self, make: Callable[[], bytes], period_s: float, instead_of: Callable[[], bytes] | None = None
    ) -> None:
        if instead_of is not None:
            self._end(instead_of)
        self._streams.setdefault(make, (self._now_s() + period_s, period_s))

    def _end(self, make: Callable[[], bytes]) -> None:
        self._streams.pop(make, None)


class LasertexHpi(Emulator):
    """An instrument that all its clients share."""

    role = "interferometer"

    class Options(LengthOptions):
        """Options.

        Attributes:
            signal_full_scale: level of a full signal.
        """

        signal_full_scale: int = Field(default=100, ge=1, le=255)

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make the instrument that all clients share."""
        options = cls.Options.of(device)
        hpi = Hpi(
            context.instrument(device.name),
            context.air.of(device.name),
            options.lengths,
            options.signal_full_scale,
        )
        return lambda: HpiSession(hpi, note)
