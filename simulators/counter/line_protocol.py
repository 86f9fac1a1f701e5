r"""Line counter dialect: the catseye default profile (sheet `interferometers`, section 9).

This is not the DISTAX protocol, which is not published: the profile of a real counter has to be completed from its
own manual. The dialect exists so that the whole measurement can be run against something that answers.

Requests are lines of ASCII ended by CR, LF or CR LF; answers are lines ended by CR LF. Grammar, `<>` for parts:

========  =======================================  ==================================================================
request   answer                                   meaning
========  =======================================  ==================================================================
``R``     ``<sign><6 digits>.<6 digits> mm``       displacement since the last zero, e.g. ``+000012.345678 mm``; fits
                                                   ``^(?P<ch>[A-Z0-9]*)\s*(?P<val>[+-]?\s*\d+(?:[.,]\d+)?``
                                                   ``(?:[Ee][+-]?\d+)?)\s*(?P<unit>\S*)``
``Z``     ``OK`` or ``E03``                        zero, clears the latches; refused when no beam returns or the
                                                   laser is not ready
``S``     ``<2 hex digits>``                       status, see below
``L``     ``<3 digits>``                           signal level in per cent, ``000`` to ``100``
``I``     ``CATSEYE LINE COUNTER EMULATOR <rev>``  identification
``V``     ``<sign><6 digits>.<6 digits> mm/s``     displacement rate
``C``     ``OK``                                   ends an error display; the latches stay, only a zero clears them
``B<n>``  ``OK``, then values as for ``R``         continuous output every n milliseconds of bench time, 1 to 60000
``H``     ``OK``                                   ends the continuous output
``E0``    ``OK``                                   echo of requests off (``E1``: on)
other     ``E01``                                  not understood
too long  ``E02``                                  more than 64 characters
========  =======================================  ==================================================================

Status bits: 0 beam lost (latched), 1 overspeed (latched), 2 no beam returns now, 3 continuous output is on,
4 laser ready. The displacement grows with the beam's length; it is corrected for the air unless the option
`compensated` is "none", and then counted in vacuum wavelengths.
"""

import re
from collections import deque
from collections.abc import Callable
from typing import Literal

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import DeviceOptions, Emulator, NewSession, Note
from catseye.simulators.lengths import Lengths
from catseye.simulators.ports.session import Answer, Session
from catseye.simulators.world.instrument import Instrument

IDENTITY = "CATSEYE LINE COUNTER EMULATOR 1.0"
LONGEST_CHARACTERS = 64

_BEAM_LOST = 0x01
_OVERSPEED = 0x02
_NO_BEAM = 0x04
_STREAMING = 0x08
_LASER_READY = 0x10

_CORRECTED = Lengths(compensated=True)

_END = re.compile(rb"[\r\n]")
_EVERY = re.compile(r"B(\d{1,5})")


class CounterSession(Session):
    """Conversation with one client.

    Args:
        note: called with each request.
        lengths: how it shows lengths; by default corrected for the air.
    """

    def __init__(
        self, instrument: Instrument, note: Callable[[str], None], lengths: Lengths = _CORRECTED
    ) -> None:
        self._lengths = lengths
        self._instrument = instrument
        self._bench = instrument.bench
        self._note = note
        self._bytes = bytearray()
        self._overflow = False
        self._lines: deque[str | None] = deque()
        self._echo = False
        self._period_s: float | None = None
        self._next_s = 0.0
        self._commands: dict[str, Callable[[], str]] = {
            "R": self._value,
            "Z": lambda: "OK" if instrument.zero() else "E03",
            "S": self._status,
            "L": lambda: f"{round(100.0 * instrument.read().level):03d}",
            "I": lambda: IDENTITY,
            "V": lambda: f"{instrument.rate_mm_s():+014.6f} mm/s",
            "C": lambda: "OK",
            "H": lambda: self._stream(None),
            "E0": lambda: self._set_echo(on=False),
            "E1": lambda: self._set_echo(on=True),
        }

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere; of an overlong line nothing is kept."""
        self._bytes += data
        while found := _END.search(self._bytes):
            self._finish(bytes(self._bytes[: found.start()]))
            del self._bytes[: found.end()]
        if len(self._bytes) > LONGEST_CHARACTERS:
            self._overflow = True
            self._bytes.clear()

    def answer(self) -> Answer | None:
        """Carry out the next request."""
        if not self._lines:
            return None
        line = self._lines.popleft()
        if line is None:
            return b"E02\r\n"
        self._note(line)
        echo = f"{line}\r\n" if self._echo else ""
        return f"{echo}{self._reply(line)}\r\n".encode("latin-1")

    def next_output_s(self) -> float | None:
        """Return when the next value of the continuous output is due."""
        return None if self._period_s is None else self._next_s

    def output(self) -> bytes:
        """Return the values that are due; values missed long ago are left out."""
        if self._period_s is None or self._bench.time_s < self._next_s:
            return b""
        missed = (self._bench.time_s - self._next_s) // self._period_s
        self._next_s += (missed + 1.0) * self._period_s
        return f"{self._value()}\r\n".encode()

    def close(self) -> None:
        """End the continuous output."""
        self._period_s = None

    def _finish(self, line: bytes) -> None:
        if self._overflow or len(line) > LONGEST_CHARACTERS:
            self._lines.append(None)
        elif line.strip():
            self._lines.append(line.decode("latin-1").strip())
        self._overflow = False

    def _reply(self, line: str) -> str:
        if line in self._commands:
            return self._commands[line]()
        found = _EVERY.fullmatch(line)
        if found is None or not 1 <= int(found[1]) <= 60_000:
            return "E01"
        return self._stream(int(found[1]) / 1e3)

    def _value(self) -> str:
        # The display has six digits before the point; a longer value would shift the columns.
        value_mm = min(999_999.0, max(-999_999.0, self._lengths.shown_mm(self._instrument.read())))
        return f"{value_mm:+014.6f} mm"

    def _status(self) -> str:
        reading = self._instrument.read()
        bits = _LASER_READY * reading.laser_ready
        bits |= _BEAM_LOST * reading.beam_lost | _OVERSPEED * reading.overspeed
        bits |= _NO_BEAM * (not reading.returns) | _STREAMING * (self._period_s is not None)
        return f"{bits:02X}"

    def _stream(self, period_s: float | None) -> str:
        self._period_s = period_s
        self._next_s = self._bench.time_s + (period_s or 0.0)
        return "OK"

    def _set_echo(self, *, on: bool) -> str:
        self._echo = on
        return "OK"


class LineCounter(Emulator):
    """A length counter that speaks the catseye default profile."""

    role = "interferometer"

    class Options(DeviceOptions):
        """Options.

        Attributes:
            compensated: "none" shows lengths in vacuum wavelengths.
        """

        compensated: Literal["instrument", "none"] = "instrument"

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make the instrument that all clients share."""
        lengths = Lengths(cls.Options.of(device).compensated == "instrument")
        instrument = context.instrument(device.name)
        return lambda: CounterSession(instrument, note, lengths)
