"""HTTP/1.1 as a client writes and reads it (RFC 9112): requests as bytes, answers decoded as they come."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final
from urllib.parse import quote, urlencode

from catseye.drivers.roles.errors import ProtocolError

LONGEST_HEAD_BYTES: Final = 16_384
LONGEST_BODY_BYTES: Final = 49_152
"""What links take of one answer is bounded."""

_END: Final = b"\r\n\r\n"
_STATUS = re.compile(rb"HTTP/1\.[01] ([1-5]\d\d)(?: [^\r\n]*)?")
_NAME = re.compile(rb"[!#$%&'*+\-.^_`|~0-9A-Za-z]+")
_BODILESS: Final = frozenset({204, 304})
_SWITCHING: Final = 101


@dataclass(frozen=True)
class Request:
    """What a server is asked.

    Attributes:
        method: GET or POST.
        path: of the resource, without a slash before it.
        query: pairs of the query.
        form: pairs of the body; None for no body.
    """

    method: str
    path: str
    query: Sequence[tuple[str, str]] = ()
    form: Sequence[tuple[str, str]] | None = None

    @property
    def target(self) -> str:
        """Path and query as they stand in the request."""
        query = f"?{urlencode(self.query)}" if self.query else ""
        return f"/{quote(self.path, safe='/;$')}{query}"

    def encoded(self, host: str, headers: Mapping[str, str]) -> bytes:
        """Return the bytes.

        Args:
            host: that is asked, with its port.
            headers: further ones.
        """
        lines = [f"{self.method} {self.target} HTTP/1.1", f"Host: {host}", "Accept: application/json"]
        body = b""
        if self.form is not None:
            body = urlencode(self.form).encode()
            lines += ["Content-Type: application/x-www-form-urlencoded", f"Content-Length: {len(body)}"]
        lines += [f"{name}: {value}" for name, value in headers.items()]
        return "\r\n".join(lines).encode("utf-8") + _END + body


@dataclass(frozen=True)
class Answer:
    """What a server said.

    Attributes:
        status: number.
        headers: names in small letters with values, in their order.
        body: whole.
    """

    status: int
    headers: tuple[tuple[str, str], ...]
    body: bytes

    def values(self, name: str) -> list[str]:
        """Return the values of a header."""
        return [value for known, value in self.headers if known == name]

    @property
    def last(self) -> bool:
        """The server ends the connection behind this answer."""
        return any("close" in value.lower() for value in self.values("connection"))


class AnswerDecoder:
    """Takes the bytes of one answer; see `Decoder` of the links. Answers of 1xx before it are passed over."""

    def __init__(self) -> None:
        self._bytes = bytearray()
        self._head: Answer | None = None
        self._body: _Counted | _Chunked | None = None

    @property
    def rest(self) -> bytes:
        """Bytes that came behind the answer."""
        return bytes(self._bytes)

    @property
    def may_end(self) -> bool:
        """Every answer says where it ends."""
        return False

    def end(self) -> Answer:
        """Refuse: silence ends no answer.

        Raises:
            ProtocolError: always.
        """
        raise ProtocolError("the answer ended before its end")

    def feed(self, data: bytes) -> Answer | None:
        """Take a chunk; return the answer when it is complete.

        Raises:
            ProtocolError: no answer begins like this.
        """
        self._bytes += data
        while self._body is None:
            head = self._next_head()
            if head is None:
                return None
            if head.status == _SWITCHING:
                raise ProtocolError("the server changes the protocol, which nobody asked it to")
            if head.status >= 200:
                self._head, self._body = head, _body_of(head)
        body = self._body.take(self._bytes)
        if body is None or self._head is None:
            return None
        return Answer(self._head.status, self._head.headers, body)

    def _next_head(self) -> Answer | None:
        end = self._bytes.find(_END)
        if end < 0:
            self._require_promising()
            return None
        if end > LONGEST_HEAD_BYTES:
            raise ProtocolError(f"the head of the answer is longer than {LONGEST_HEAD_BYTES} bytes")
        head = _head_of(bytes(self._bytes[:end]))
        del self._bytes[: end + len(_END)]
        return head

    def _require_promising(self) -> None:
        """Refuse what can become no head any more."""
        if len(self._bytes) > LONGEST_HEAD_BYTES:
            raise ProtocolError(f"the head of the answer is longer than {LONGEST_HEAD_BYTES} bytes")
        beginning = b"HTTP/1."
        if self._bytes[: len(beginning)] != beginning[: len(self._bytes)]:
            raise ProtocolError("this is not an answer of a web server")


class _Counted:
    """A body of a known length."""

    def __init__(self, length: int) -> None:
        self._length = length

    def take(self, data: bytearray) -> bytes | None:
        """Return the body and take it from the bytes, once it is whole."""
        if len(data) < self._length:
            return None
        body = bytes(data[: self._length])
        del data[: self._length]
        return body


class _Chunked:
    """A body in chunks, each with its length before it, and perhaps headers behind the last one."""

    def __init__(self) -> None:
        self._body = bytearray()
        self._trailing = False

    def take(self, data: bytearray) -> bytes | None:
        """Take chunks from the bytes; return the body behind the last one.

        Raises:
            ProtocolError: this is no chunk, or the body is too long.
        """
        while (line := _line_of(data)) is not None:
            if self._trailing:
                del data[: len(line) + 2]
                if not line:
                    return bytes(self._body)
                continue
            size = _size_of(line)
            if len(self._body) + size > LONGEST_BODY_BYTES:
                raise ProtocolError(f"the body of the answer is longer than {LONGEST_BODY_BYTES} bytes")
            begin = len(line) + 2
            if size and len(data) < begin + size + 2:
                return None
            if size and data[begin + size : begin + size + 2] != b"\r\n":
                raise ProtocolError("a chunk of the answer does not end where it should")
            self._body += data[begin : begin + size]
            del data[: begin + size + 2 if size else begin]
            self._trailing = not size
        return None


def _line_of(data: bytearray) -> bytes | None:
    end = data.find(b"\r\n")
    if end > LONGEST_HEAD_BYTES or (end < 0 and len(data) > LONGEST_HEAD_BYTES):
        raise ProtocolError("a line of the answer has no end")
    return None if end < 0 else bytes(data[:end])


def _size_of(line: bytes) -> int:
    text = line.partition(b";")[0].strip()
    if not re.fullmatch(rb"[0-9A-Fa-f]{1,8}", text):
        raise ProtocolError(f"{text[:20]!r} is not a chunk length")
    return int(text, 16)


def _head_of(head: bytes) -> Answer:
    first, *lines = head.split(b"\r\n")
    found = _STATUS.fullmatch(first)
    if found is None:
        raise ProtocolError("the answer begins with no status")
    headers = []
    for line in lines:
        name, colon, value = line.partition(b":")
        if not colon or not _NAME.fullmatch(name):
            raise ProtocolError("the head of the answer has a line that is no header")
        headers.append((name.decode("ascii").lower(), value.strip().decode("latin-1")))
    return Answer(int(found[1]), tuple(headers), b"")


def _body_of(head: Answer) -> _Counted | _Chunked:
    if head.status in _BODILESS:
        return _Counted(0)
    encodings = head.values("transfer-encoding")
    if encodings:
        if [encoding.lower() for encoding in encodings] != ["chunked"]:
            raise ProtocolError(f"the answer is encoded as {', '.join(encodings)[:40]}")
        return _Chunked()
    lengths = set(head.values("content-length"))
    text = lengths.pop() if len(lengths) == 1 else ""
    if not (text.isascii() and text.isdecimal()) or len(text) > 8 or int(text) > LONGEST_BODY_BYTES:
        raise ProtocolError(
            f"the length of the answer is missing, wrong, or beyond {LONGEST_BODY_BYTES} bytes"
        )
    return _Counted(int(text))
