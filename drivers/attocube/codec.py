"""JSON-RPC of the attocube IDS3010: requests and the lines of answers. Pure."""

import contextlib
import json
import math
from dataclasses import dataclass
from typing import Literal

from catseye.drivers.roles.errors import ProtocolError

Dialect = Literal["ids", "sen"]
"""`ids`: com.attocube.ids, as in the IDS3010; `sen`: com.attocube.sen, the newer generation."""

MAX_LINE_BYTES = 65_536
MM_PER_PM = 1e-9


def encode(method: str, params: tuple[object, ...], number: int, dialect: Dialect) -> bytes:
    """Return a request; it ends with its last brace.

    Args:
        params: its parameters; without any the key is left out.
        number: of the request; the answer carries the same.
        dialect: the newer generation wants to be named in each request.
    """
    request: dict[str, object] = {"jsonrpc": "2.0", "method": method, "api": 2, "id": number}
    if params:
        request["params"] = list(params)
    if dialect == "sen":
        request["pid"] = "sen"
    return json.dumps(request).encode("ascii")


@dataclass(frozen=True)
class Answer:
    """The result of a request.

    Attributes:
        error: number of the error or warning; 0 for none.
        values: what was asked for.
    """

    error: int
    values: tuple[object, ...]

    def number(self, index: int = 0) -> float:
        """Return a value that is a number.

        Raises:
            ProtocolError: it is missing or none.
        """
        value = self.values[index] if index < len(self.values) else None
        number = math.nan
        if isinstance(value, int | float) and not isinstance(value, bool):
            # JSON has integers that are larger than any float.
            with contextlib.suppress(OverflowError):
                number = float(value)
        if not math.isfinite(number):
            raise ProtocolError(f"the answer {str(self.values)[:64]} has no number at place {index}")
        return number

    def text(self) -> str:
        """Return the first value as text, empty without one."""
        return str(self.values[0]) if self.values else ""


class AnswerDecoder:
    """Takes the line that answers one request."""

    may_end = False
    """Silence never ends a line."""

    def __init__(self, number: int) -> None:
        self._number = number
        self._buffer = b""
        self.rest = b""

    def feed(self, data: bytes) -> Answer | None:
        """Take a chunk; return the answer when its line is complete.

        Raises:
            ProtocolError: no answer to this request, or a line that does not end.
        """
        self._buffer += data
        line, end, rest = self._buffer.lstrip(b"\r\n").partition(b"\n")
        if end:
            self.rest, self._buffer = rest, b""
            return self._parse(line)
        if len(self._buffer) > MAX_LINE_BYTES:
            raise ProtocolError(f"a line longer than {MAX_LINE_BYTES} bytes does not end")
        return None

    def end(self) -> Answer:
        """Refuse: silence does not end a line.

        Raises:
            ProtocolError: always.
        """
        raise ProtocolError("a line without end")

    def _parse(self, line: bytes) -> Answer:
        try:
            said = json.loads(line)
        except (ValueError, RecursionError):
            raise ProtocolError(f"{line[:64]!r} is not JSON") from None
        if not isinstance(said, dict) or said.get("id") != self._number:
            raise ProtocolError(f"{line[:64]!r} does not answer request {self._number}")
        if "error" in said:
            raise ProtocolError(f"the request was not understood: {json.dumps(said['error'])[:200]}")
        return _result(said.get("result"))


def _result(result: object) -> Answer:
    if isinstance(result, str):
        # Some generations answer a question for a text by the bare text.
        return Answer(0, (result,))
    if not isinstance(result, list) or not result or not isinstance(result[0], int):
        raise ProtocolError(f"the result {str(result)[:64]!r} does not begin with an error number")
    return Answer(result[0], tuple(result[1:]))
