"""A client of the emulated proxy, on bench time."""

import struct

from catseye.simulators.kuka.varproxy import Proxy, VarproxySession
from catseye.simulators.ports.session import Pending
from tests.unit.simulators.kuka.benches import kuka_bench


class Client:
    """Asks a session on bench time."""

    def __init__(self, *, old: bool = False, longest_bytes: int = 0xFFFF) -> None:
        self.emulation = kuka_bench()
        self.bench = self.emulation.bench
        self.requests: list[str] = []
        variables = self.emulation.controller.variables
        self.proxy = Proxy(self.bench, variables, 1, old=old, longest_bytes=longest_bytes)
        self.session = VarproxySession(self.proxy, self.requests.append)

    def ask(self, data: bytes) -> bytes:
        self.session.feed(data)
        answer = self.session.answer()
        assert isinstance(answer, Pending)
        due_s = answer.due()
        assert due_s is not None
        self.bench.advance_to(due_s)
        assert answer.due() is None
        return answer.reply()

    def say(self, kind: int, payload: bytes) -> tuple[bytes, int, int]:
        """Return the payload of a reply, its error and its success."""
        reply = self.ask(struct.pack(">HHB", 5, 1 + len(payload), kind) + payload)
        tag, length = struct.unpack_from(">HH", reply)
        assert (tag, length, reply[4]) == (5, len(reply) - 4, kind)
        error, success = struct.unpack(">HB", reply[-3:])
        return reply[5:-3], error, success

    def read(self, name: str) -> str:
        payload, error, success = self.say(0, narrow(name))
        assert (error, success) == (1, 1)
        return payload[2:].decode("ascii")


def narrow(text: str) -> bytes:
    return struct.pack(">H", len(text)) + text.encode("ascii")


def wide(text: str) -> bytes:
    return struct.pack(">H", len(text)) + text.encode("utf-16-le")
