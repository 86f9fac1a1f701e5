"""Modbus function 08: counters of what came over the line, echo, and the mode in which a device only listens.

Sub-functions and what they count: Vaisala's manuals of PTU300 (M210796EN-G, table 50), HMT330 (M210566EN-K, table 46)
and DMT340, which have them over TCP as well. Assumed: a request counts itself; a frame with a wrong check counts as
an error and not as a message; counters begin again at 0 after 65535; a request with data where there should be none
is answered with exception 3.
"""

from collections.abc import Callable
from dataclasses import dataclass

from catseye.simulators.modbus.exceptions import ILLEGAL_FUNCTION, ILLEGAL_VALUE, ModbusError

RESTART = bytes.fromhex("08 0001 0000")
"""The only request to which a device that only listens pays attention; it is not answered then."""

_ECHO, _RESTART, _REGISTER, _LISTEN, _CLEAR = 0, 1, 2, 4, 10
_NO_DATA = b"\x00\x00"


@dataclass
class Diagnostics:
    """What a device knows of its link.

    Attributes:
        messages: frames seen, whoever they were for.
        frame_errors: frames with a wrong check, or bytes that are no frame.
        exceptions: exceptions sent.
        processed: requests carried out.
        unanswered: requests that got no answer: broadcasts, and all while it only listens.
        listens_only: it neither carries out nor answers.
    """

    messages: int = 0
    frame_errors: int = 0
    exceptions: int = 0
    processed: int = 0
    unanswered: int = 0
    listens_only: bool = False

    def carry_out(self, body: bytes, register: int) -> bytes:
        """Return the answer to a request of function 08, both without its code; empty bytes: no answer.

        Args:
            register: the device's diagnostic register.

        Raises:
            ModbusError: no such sub-function, or wrong data.
        """
        if len(body) < 4 or len(body) % 2:
            raise ModbusError(ILLEGAL_VALUE)
        code, data = int.from_bytes(body[:2], "big"), body[2:]
        if code == _ECHO:
            return body
        answers = self._answers(register)
        if code not in answers:
            raise ModbusError(ILLEGAL_FUNCTION)
        if data != _NO_DATA:
            raise ModbusError(ILLEGAL_VALUE)
        value = answers[code]()
        return b"" if value is None else body[:2] + (value & 0xFFFF).to_bytes(2, "big")

    def clear(self) -> int:
        """Set all counters to 0."""
        self.messages = self.frame_errors = self.exceptions = self.processed = self.unanswered = 0
        return 0

    def _answers(self, register: int) -> dict[int, Callable[[], int | None]]:
        return {
            _RESTART: self._restart,
            _REGISTER: lambda: register,
            _LISTEN: self._listen,
            _CLEAR: self.clear,
            11: lambda: self.messages,
            12: lambda: self.frame_errors,
            13: lambda: self.exceptions,
            14: lambda: self.processed,
            15: lambda: self.unanswered,
        }

    def _restart(self) -> int:
        self.listens_only = False
        return self.clear()

    def _listen(self) -> None:
        self.listens_only = True
