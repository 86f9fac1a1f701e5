"""One client of the proxy: what it asks is carried out in turn, one request of all clients after the other.

A request takes 5 to 15 ms of bench time (sheet A1). What has come is carried out even where its client is gone.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Final

from catseye.simulators.kuka.frames import (
    LONGEST_BYTES,
    ErrorCode,
    Frame,
    FrameBuffer,
    PayloadError,
    PayloadReader,
    ascii_text,
    empty_reply,
    old_reply,
    reply,
    utf16_text,
)
from catseye.simulators.kuka.values import ValueTextError
from catseye.simulators.kuka.variables import UnknownVariableError, Variables, WriteProtectedError
from catseye.simulators.ports.session import Answer, Session
from catseye.simulators.ports.turns import Turns
from catseye.simulators.world.timed_bench import TimedBench

INTERNAL: Final = {
    "@PROXY_TYPE": "C3 BRIDGE INTERFACE",
    "@PROXY_VERSION": "1.7",
    "@PROXY_FEATURES": "",
    "@PROXY_HOSTNAME": "EMULATOR",
    "@PROXY_TIME": "0",
    "@PROXY_ADDRESS": "127.0.0.1",
    "@PROXY_PORT": "7000",
    "@PROXY_ENABLED": "TRUE",
}
"""Names that the proxy answers itself."""

_OVERHEAD_BYTES = 4

OLD_IDLE_S: Final = 31.0
"""A KUKAVARPROXY of old looks once a second for clients that were silent for more than 30 s (frmMain.frm)."""


class Proxy:
    """What the clients of one proxy share.

    Args:
        bench: whose time it lives in.
        variables: of the controller.
        seed: of how long requests take.
        longest_bytes: of the rest of a reply; more is refused as a long answer.
        old: it is a KUKAVARPROXY of old: it knows PING and single ASCII variables, says no errors, and closes a
            connection that is idle.
        loses: what comes while a request is carried out is lost, as the published source of a KUKAVARPROXY has it
            (bReadPending) where the call to the controller lets its window take further messages.
    """

    def __init__(
        self,
        bench: TimedBench,
        variables: Variables,
        seed: int,
        *,
        longest_bytes: int = LONGEST_BYTES,
        old: bool = False,
        loses: bool = False,
    ) -> None:
        self.turns = Turns(bench, seed, 20)
        self.longest_bytes = longest_bytes
        self.old = old
        self.loses = loses
        self._variables = variables

    def read(self, name: str) -> tuple[ErrorCode, str]:
        """Return a variable's value, or why there is none."""
        try:
            return ErrorCode.SUCCESS, self._variables.read(name)
        except UnknownVariableError:
            own = "PONG" if name == "PING" else "" if self.old else INTERNAL.get(name, "")
            return (ErrorCode.SUCCESS, own) if own else (ErrorCode.ARGUMENT, "")

    def write(self, name: str, text: str) -> tuple[ErrorCode, str]:
        """Write a variable; return what is read back, or why it was not written."""
        try:
            return ErrorCode.SUCCESS, self._variables.write(name, text)
        except WriteProtectedError:
            return ErrorCode.ACCESS, ""
        except (UnknownVariableError, ValueTextError):
            return ErrorCode.ARGUMENT, ""


class VarproxySession(Session):
    """Conversation with one client.

    Args:
        note: called with each request.
    """

    def __init__(self, proxy: Proxy, note: Callable[[str], None]) -> None:
        self._proxy = proxy
        self._note = note
        self._buffer = FrameBuffer(forgets=proxy.old)
        self._idle = False

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere."""
        if self._proxy.loses and self._proxy.turns.busy:
            self._note("lost: reading pending")
            return
        self._buffer.feed(data)

    @property
    def over(self) -> bool:
        """The proxy has closed a connection that was idle."""
        return self._idle

    def silence_s(self) -> float | None:
        """Return how long a client may be silent, real s; None for as long as it likes."""
        return OLD_IDLE_S if self._proxy.old else None

    def idle(self) -> None:
        """Close the connection."""
        self._note("idle: closed")
        self._idle = True

    def answer(self) -> Answer | None:
        """Have the next request carried out in its turn."""
        request = self._buffer.take()
        if request is None:
            return None
        return self._proxy.turns.take(partial(answer_to, request, self._proxy, self._note))

    def close(self) -> None:
        """Carry out what the client sent before it went."""
        while self.answer() is not None:
            pass


def answer_to(request: Frame, proxy: Proxy, note: Callable[[str], None]) -> bytes:
    """Carry out a request; return the reply."""
    if proxy.old:
        return _old_answer_to(request, proxy, note)
    carry_out = _KINDS.get(request.kind)
    if carry_out is None:
        note(f"type {request.kind}")
        return reply(request, b"", ErrorCode.NOT_IMPLEMENTED)
    payload, error = carry_out(PayloadReader(request.payload), proxy, note)
    if len(payload) + _OVERHEAD_BYTES > proxy.longest_bytes:
        return reply(request, b"\0" if request.kind in _MULTIPLE else ascii_text(""), ErrorCode.LONG_ANSWER)
    return reply(request, payload, error)


def _old_answer_to(request: Frame, proxy: Proxy, note: Callable[[str], None]) -> bytes:
    """Return what a KUKAVARPROXY of old says, by its published source (basMain.bas).

    It reads what does not exist as an empty text, with success; a write that fails repeats the value.
    """
    reader = PayloadReader(request.payload)
    match request.kind:
        case 0:
            name = reader.ascii_or_rest()
            note(f"read {name}")
            return old_reply(request, ascii_text(proxy.read(name)[1]), success=True)
        case 1:
            name, text = reader.ascii_or_rest(), reader.ascii_or_rest()
            note(f"write {name} = {text}")
            error, _ = proxy.write(name, text)
            return old_reply(request, ascii_text(text), success=error is ErrorCode.SUCCESS)
        case 2 | 3:
            # Arrays of whole numbers, of which this controller has none.
            note(f"type {request.kind}")
            return old_reply(request, ascii_text(""), success=request.kind == 2)
        case _:
            note(f"type {request.kind}")
            return empty_reply(request)


_Done = tuple[bytes, ErrorCode]
_Carry = Callable[[PayloadReader, Proxy, Callable[[str], None]], _Done]


def _read_ascii(reader: PayloadReader, proxy: Proxy, note: Callable[[str], None]) -> _Done:
    try:
        name = reader.ascii()
    except PayloadError:
        return ascii_text(""), ErrorCode.GENERAL
    note(f"read {name}")
    error, text = proxy.read(name)
    # The open server says no more than that it failed.
    return ascii_text(text), ErrorCode.SUCCESS if error is ErrorCode.SUCCESS else ErrorCode.GENERAL


def _write_ascii(reader: PayloadReader, proxy: Proxy, note: Callable[[str], None]) -> _Done:
    try:
        name, text = reader.ascii(), reader.ascii()
    except PayloadError:
        return ascii_text(""), ErrorCode.GENERAL
    note(f"write {name} = {text}")
    error, _ = proxy.write(name, text)
    if error is ErrorCode.SUCCESS:
        return ascii_text(text), error
    return ascii_text(""), ErrorCode.GENERAL


def _read_utf16(reader: PayloadReader, proxy: Proxy, note: Callable[[str], None]) -> _Done:
    try:
        name = reader.utf16()
    except PayloadError:
        return utf16_text(""), ErrorCode.PROTOCOL
    note(f"read {name}")
    error, text = proxy.read(name)
    return utf16_text(text), error


def _write_utf16(reader: PayloadReader, proxy: Proxy, note: Callable[[str], None]) -> _Done:
    try:
        name, text = reader.utf16(), reader.utf16()
    except PayloadError:
        return utf16_text(""), ErrorCode.PROTOCOL
    note(f"write {name} = {text}")
    error, _ = proxy.write(name, text)
    return utf16_text(text if error is ErrorCode.SUCCESS else ""), error


def _multiple(
    texts: int,
    one: Callable[[Sequence[str], Proxy, Callable[[str], None]], tuple[ErrorCode, str]],
    reader: PayloadReader,
    proxy: Proxy,
    note: Callable[[str], None],
) -> _Done:
    try:
        count = reader.byte()
        # The whole request is read before any of it is carried out.
        asked = [[reader.utf16() for _ in range(texts)] for _ in range(count)]
    except PayloadError:
        return b"\0", ErrorCode.PROTOCOL
    found = [one(each, proxy, note) for each in asked]
    payload = bytes([count]) + b"".join(bytes([error]) + utf16_text(text) for error, text in found)
    failed = any(error is not ErrorCode.SUCCESS for error, _ in found)
    return payload, ErrorCode.GENERAL if failed else ErrorCode.SUCCESS


def _read_one(asked: Sequence[str], proxy: Proxy, note: Callable[[str], None]) -> tuple[ErrorCode, str]:
    (name,) = asked
    note(f"read {name}")
    return proxy.read(name)


def _write_one(asked: Sequence[str], proxy: Proxy, note: Callable[[str], None]) -> tuple[ErrorCode, str]:
    name, text = asked
    note(f"write {name} = {text}")
    error, kept = proxy.write(name, text)
    return error, kept if error is ErrorCode.SUCCESS else text


_MULTIPLE: Final = frozenset({6, 7})
_KINDS: Final[Mapping[int | None, _Carry]] = {
    0: _read_ascii,
    1: _write_ascii,
    4: _read_utf16,
    5: _write_utf16,
    6: partial(_multiple, 1, _read_one),
    7: partial(_multiple, 2, _write_one),
}
