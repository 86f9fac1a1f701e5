"""attocube IDS: JSON-RPC 2.0 on TCP 9090 (sheet `interferometers`, section 4).

A request is one JSON object, with or without an end of line behind it; an answer is one line that ends with CR LF and
carries the same id. A result is an array that begins with an error number; of some methods clients read the values
behind it even when it is not 0.
"""

import json
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TypeVar

from catseye.simulators.attocube.access import Client
from catseye.simulators.attocube.device import Ids, IdsOptions
from catseye.simulators.attocube.errors import IdsError, blanks
from catseye.simulators.attocube.results import Later, Method, Result
from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import Emulator, NewSession, Note
from catseye.simulators.ports.session import Answer, Pending, Session

_NOT_JSON = (-32700, "Parse error")
_NO_REQUEST = (-32600, "Invalid Request")
_NO_METHOD = (-32601, "Method not found")
_BAD_PARAMS = (-32602, "Invalid params")


LONGEST_BYTES = 65_536
DEEPEST = 32

_OPEN, _CLOSE = b"{[", b"}]"

_R = TypeVar("_R", bound=Result)


class JsonCutter:
    """Finds where each object ends by its braces; what stands between objects is passed over.

    An object that is too long or too deep is given out as empty bytes, once, and nothing of it is kept.
    """

    def __init__(self) -> None:
        self._object = bytearray()
        self._depth = 0
        self._in_text = False
        self._escaped = False

    def feed(self, data: bytes) -> list[bytes]:
        """Take bytes, cut anywhere; return the objects that are complete."""
        objects: list[bytes] = []
        for byte in data:
            if not self._depth and byte != ord("{"):
                continue
            self._object.append(byte)
            self._step(byte)
            if not self._depth:
                objects.append(bytes(self._object))
                self._forget()
            elif len(self._object) > LONGEST_BYTES or self._depth > DEEPEST:
                objects.append(b"")
                self._forget()
        return objects

    def _step(self, byte: int) -> None:
        if self._in_text:
            if self._escaped:
                self._escaped = False
            elif byte == ord("\\"):
                self._escaped = True
            elif byte == ord('"'):
                self._in_text = False
        elif byte == ord('"'):
            self._in_text = True
        elif byte in _OPEN:
            self._depth += 1
        elif byte in _CLOSE:
            self._depth -= 1

    def _forget(self) -> None:
        self._object.clear()
        self._depth = 0
        self._in_text = self._escaped = False


class IdsSession(Session):
    """Conversation with one client.

    Args:
        note: called with each request.
    """

    def __init__(self, ids: Ids, note: Callable[[str], None]) -> None:
        self._ids = ids
        self._note = note
        self._client = Client()
        self._lock = ids.access.methods(self._client)
        self._boots = ids.boots if ids.is_up else -1
        self._cutter = JsonCutter()
        self._objects: deque[bytes] = deque()

    @property
    def over(self) -> bool:
        """The instrument has rebooted since, or does so."""
        return self._boots != self._ids.boots

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere."""
        self._objects += self._cutter.feed(data)

    def answer(self) -> Answer | None:
        """Carry out the next request."""
        if not self._objects:
            return None
        try:
            request = json.loads(self._objects.popleft())
        except ValueError:
            return _line(None, _failure(_NOT_JSON))
        number = request.get("id")
        if not isinstance(number, int | str | None):
            number = None
        said = self._carry_out(request.get("method"), request.get("params", []))
        if isinstance(said, Later):
            return Pending(said.due, lambda: _line(number, {"result": said.result()}))
        return _line(number, said)

    def _carry_out(self, method: object, params: object) -> dict[str, object] | Later:
        if not isinstance(method, str):
            return _failure(_NO_REQUEST)
        if not isinstance(params, list):
            return _failure(_BAD_PARAMS)
        self._note(f"{method}{json.dumps(params)}"[:200])
        function = self._lock.get(method) or self._ids.methods.get(method)
        if function is None:
            return _failure(_NO_METHOD)
        try:
            result = _told(method, partial(self._call, method, function, params))
        except (TypeError, ValueError):
            return _failure(_BAD_PARAMS)
        if isinstance(result, Later):
            return replace(result, result=partial(_told, method, result.result))
        return {"result": result}

    def _call(self, method: str, function: Method, params: list[object]) -> Result:
        if method not in self._lock:
            self._ids.access.require(self._client, method)
        return function(*params)


def _told(method: str, call: Callable[[], _R]) -> _R | list[object]:
    """Return what a method gives back; an error becomes its number."""
    try:
        return call()
    except IdsError as error:
        return [error.number, *blanks(method)]


def _failure(error: tuple[int, str]) -> dict[str, object]:
    return {"error": {"code": error[0], "message": error[1]}}


def _line(number: int | str | None, said: dict[str, object]) -> bytes:
    return json.dumps({"jsonrpc": "2.0", **said, "id": number}).encode("ascii") + b"\r\n"


class AttocubeIds(Emulator):
    """An instrument that all its clients share."""

    role = "interferometer"
    Options = IdsOptions

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make the instrument that all clients share."""
        ids = Ids(
            context.instrument(device.name),
            context.air.of(device.name),
            cls.Options.of(device),
            context.config.seed,
        )
        return lambda: IdsSession(ids, note)
