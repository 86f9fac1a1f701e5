"""Heidenhain ND 28x: commands over a serial line (sheet `interferometers`, section 6).

Known are the commands, the length of their answers, the order of the indicators, that A0100 sends an error that is on
the display, and that the error text is there for a displayed error only. Not known, and assumed here: a lost beam
shows the error SIGNAL until C is pressed; meanwhile no measured value is printed (NAK) while the position goes on; a
datum is set by digits and ENT; what is not understood is answered by NAK. Options choose what answers a question for
the text of no error, and whether A0800 is the status bar of an ND 287 or the indicators of older units.
"""

import re
from collections import deque
from collections.abc import Callable
from typing import Literal

from pydantic import Field

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import Emulator, NewSession, Note
from catseye.simulators.lengths import LengthOptions, Lengths
from catseye.simulators.ports.session import Answer, Session
from catseye.simulators.world.instrument import Instrument

BUFFER_BYTES = 100

_STX, _ACK, _NAK = b"\x02", b"\x06", b"\x15"
_LARGEST = 999_999_999
_ERROR = "SIGNAL"
_KEYS = {f"T000{digit}": str(digit) for digit in range(10)} | {"T0101": "-", "T0102": "."}
_CLEAR, _ENTER = "T0100", "T0104"
_LONGEST_ENTRY = 12
_COMMAND = re.compile(rb"\x1b([A-Z]\d{4})\r")
_NEXT = re.compile(rb"\x02|\x1b[^\x1b\r]*\r|[^\x02\x1b\r\n]*\r")


class NdOptions(LengthOptions):
    """Options.

    Attributes:
        decimals: digits behind the decimal point.
        no_error: answer to a question for the error text while there is no error: blanks, or a refusal.
        status_bar: A0800 gives the status bar of an ND 287; older units give the indicators.
    """

    decimals: int = Field(default=4, ge=0, le=7)
    no_error: Literal["blank", "refused"] = "blank"
    status_bar: bool = True


class Display:
    """The display that all clients share."""

    def __init__(self, instrument: Instrument, lengths: Lengths, options: NdOptions) -> None:
        self._instrument = instrument
        self._lengths = lengths
        self._decimals = options.decimals
        self._no_error = options.no_error
        self._datum_mm = 0.0
        self._breaks_cleared = 0
        self._reference = self._locked = False
        self._entry = ""
        self._restart()
        self.commands: dict[str, Callable[[], bytes]] = {
            "A0000": lambda: _lines("ND 287", "EMULATOR", "1.0", width=10),
            "A0100": self.displayed,
            "A0200": lambda: _lines(f"{self._steps():+010d}"),
            "A0300": self._error,
            "A0301": self._error,
            "A0400": lambda: _lines("EMULATOR", width=10),
            "A0800": self._status_bar if options.status_bar else self._indicators,
            "A0900": self._indicators,
            "F0000": self._toggle_reference,
            "F0100": lambda: _ACK,
            "F0200": self.measured,
            "S0000": self._restart,
            "S0001": lambda: self._lock(on=True),
            "S0002": lambda: self._lock(on=False),
        }

    def carry_out(self, command: str) -> bytes:
        """Return the answer to a command."""
        if command in self.commands:
            return self.commands[command]()
        return self._press(command) if not self._locked else _NAK

    def displayed(self) -> bytes:
        """Return what is displayed: the value, or the error."""
        return _lines(_ERROR, width=10) if self._fault() else self.measured()

    def measured(self) -> bytes:
        """Return the measured value; there is none while an error is shown."""
        if self._fault():
            return _NAK
        return _lines(
            f"{self._steps() / 10.0**self._decimals:+0{11 if self._decimals else 10}.{self._decimals}f}"
        )

    def _steps(self) -> int:
        """Return the position in steps of the last digit."""
        value_mm = self._lengths.shown_mm(self._instrument.read()) - self._datum_mm
        return max(-_LARGEST, min(_LARGEST, round(value_mm * 10.0**self._decimals)))

    def _fault(self) -> bool:
        lost = not self._instrument.read().counts
        return lost or self._instrument.break_count > self._breaks_cleared

    def _error(self) -> bytes:
        if not self._fault() and self._no_error == "refused":
            return _NAK
        return _lines(_ERROR if self._fault() else "", width=13)

    def _status_bar(self) -> bytes:
        """Say: actual value, X1, no scale, no compensation, stopwatch stopped, mm, datum 1, page 1."""
        return _lines("00000011")

    def _indicators(self) -> bytes:
        return _lines(("1" if self._reference else "0") + "1" + "0" * 12)

    def _toggle_reference(self) -> bytes:
        self._reference = not self._reference
        return _ACK

    def _lock(self, *, on: bool) -> bytes:
        self._locked = on
        return _ACK

    def _restart(self) -> bytes:
        """Be as after switching on."""
        self._datum_mm = self._lengths.shown_mm(self._instrument.read())
        self._breaks_cleared = self._instrument.break_count
        self._reference = self._locked = False
        self._entry = ""
        return _ACK

    def _press(self, key: str) -> bytes:
        if key in _KEYS and len(self._entry) < _LONGEST_ENTRY:
            self._entry += _KEYS[key]
        elif key == _CLEAR:
            self._entry = ""
            self._breaks_cleared = self._instrument.break_count
        elif key == _ENTER:
            return self._set_datum()
        else:
            return _NAK
        return _ACK

    def _set_datum(self) -> bytes:
        entry, self._entry = self._entry, ""
        try:
            value_mm = float(entry)
        except ValueError:
            return _NAK
        self._datum_mm = self._lengths.shown_mm(self._instrument.read()) - value_mm
        return _ACK


class NdSession(Session):
    """Conversation with one client.

    Args:
        note: called with each command.
    """

    def __init__(self, display: Display, note: Callable[[str], None]) -> None:
        self._display = display
        self._note = note
        self._bytes = b""
        self._commands: deque[bytes] = deque()

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere; of a command longer than the input buffer nothing is kept."""
        self._bytes += data.translate(None, b"\n\x11\x13")
        while found := _NEXT.search(self._bytes):
            self._commands.append(found[0] if len(found[0]) <= BUFFER_BYTES else b"")
            self._bytes = self._bytes[found.end() :]
        if len(self._bytes) > BUFFER_BYTES:
            self._bytes = b"\x1b"

    def answer(self) -> Answer | None:
        """Carry out the next command."""
        if not self._commands:
            return None
        data = self._commands.popleft()
        if data == _STX:
            self._note("STX")
            return self._display.measured()
        found = _COMMAND.fullmatch(data)
        if found is None:
            return _NAK
        command = found[1].decode("ascii")
        self._note(command)
        return self._display.carry_out(command)


def _lines(*texts: str, width: int = 0) -> bytes:
    return _STX + b"".join(text.ljust(width).encode("ascii") + b"\r\n" for text in texts)


class HeidenhainNd(Emulator):
    """A display that all its clients share."""

    role = "interferometer"

    Options = NdOptions

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make the display that all clients share."""
        options = cls.Options.of(device)
        display = Display(context.instrument(device.name), options.lengths, options)
        return lambda: NdSession(display, note)
