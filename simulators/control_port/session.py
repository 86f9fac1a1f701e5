"""Conversation with the clients of the control port."""

from pydantic import ValidationError

from catseye.simulators.control_port.messages import decode_request, encode_answer, encode_refusal
from catseye.simulators.control_port.operations import Reach, carry_out
from catseye.simulators.errors import EmulatorError
from catseye.simulators.ports.session import Answer, Session

LONGEST_BYTES = 65_536


class ControlSession(Session):
    """Conversation with one client of the control port."""

    def __init__(self, reach: Reach) -> None:
        self._reach = reach
        self._bytes = bytearray()

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere."""
        self._bytes += data

    def answer(self) -> Answer | None:
        """Carry out the next line."""
        line, newline, rest = self._bytes.partition(b"\n")
        if not newline and len(self._bytes) <= LONGEST_BYTES:
            return None
        self._bytes = rest
        try:
            return encode_answer(carry_out(decode_request(bytes(line)), self._reach))
        except ValidationError as error:
            first = error.errors()[0]
            key = ".".join(str(part) for part in first["loc"])
            return encode_refusal(f"{key}: {first['msg']}")
        except EmulatorError as error:
            return encode_refusal(str(error))
