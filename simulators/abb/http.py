"""HTTP/1.1 as a server reads and writes it (RFC 9112): requests cut anywhere, answers with their length."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final
from urllib.parse import parse_qs, unquote, urlsplit

LONGEST_HEAD_BYTES: Final = 16_384
LONGEST_BODY_BYTES: Final = 1 << 20
_END: Final = b"\r\n\r\n"
_LINE = re.compile(rb"([A-Z]{3,10}) (\S+) HTTP/1\.([01])")
_NAMED: Final = {
    101: "Switching Protocols",
    200: "OK",
    201: "Created",
    204: "No Content",
    400: "Bad Request",
    401: "Unauthorized",
    403: "Forbidden",
    404: "Not Found",
    405: "Method Not Allowed",
    411: "Length Required",
    413: "Content Too Large",
    503: "Service Unavailable",
}


class BadRequestError(Exception):
    """What came is no request; nothing behind it can be read.

    Args:
        status: to answer with.
    """

    def __init__(self, status: int) -> None:
        super().__init__(status)
        self.status = status


@dataclass(frozen=True)
class Request:
    """What a client asks.

    Attributes:
        method: GET, POST, PUT, DELETE and so on.
        target: as it stands in the request.
        headers: by their names in small letters.
        body: as it came.
        old: HTTP/1.0, whose connections end behind the answer.
    """

    method: str
    target: str
    headers: Mapping[str, str]
    body: bytes = b""
    old: bool = False

    @property
    def path(self) -> str:
        """The path without its query, decoded, without slashes at its ends.

        `abb_robot_client` asks once for a whole address behind the host: its path counts.
        """
        whole = self.target.lstrip("/") if "://" in self.target else self.target
        return unquote(urlsplit(whole).path).strip("/")

    @property
    def query(self) -> dict[str, str]:
        """The last value of each key of the query."""
        return {key: values[-1] for key, values in parse_qs(urlsplit(self.target).query).items()}

    @property
    def form(self) -> dict[str, list[str]]:
        """The values of each key of a form in the body."""
        return parse_qs(self.body.decode("utf-8", "replace"), keep_blank_values=True)

    @property
    def last(self) -> bool:
        """The connection ends behind the answer."""
        wish = self.headers.get("connection", "").lower()
        return "close" in wish or (self.old and "keep-alive" not in wish)


@dataclass(frozen=True)
class Answer:
    """What a server says.

    Attributes:
        status: number.
        body: may be empty.
        kind: of the body.
        headers: further ones, in their order.
    """

    status: int
    body: bytes = b""
    kind: str = "text/html"
    headers: tuple[tuple[str, str], ...] = field(default=())

    def encoded(self, *, last: bool) -> bytes:
        """Return the bytes; `last` says that the connection ends behind them."""
        named = [f"HTTP/1.1 {self.status} {_NAMED[self.status]}", "Server: IRC5 EMULATOR"]
        named += [f"{name}: {value}" for name, value in self.headers]
        if self.status not in {101, 204}:
            named += [f"Content-Type: {self.kind}", f"Content-Length: {len(self.body)}"]
        if self.status != 101:
            named.append(f"Connection: {'close' if last else 'keep-alive'}")
        return "\r\n".join(named).encode("latin-1", "replace") + _END + self.body


class RequestBuffer:
    """Cuts a stream into requests."""

    def __init__(self) -> None:
        self._bytes = bytearray()

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere."""
        self._bytes += data

    def take(self) -> Request | None:
        """Return the next complete request.

        Raises:
            BadRequestError: there is none to come.
        """
        head, end, _ = self._bytes.partition(_END)
        if not end:
            if len(self._bytes) > LONGEST_HEAD_BYTES:
                raise BadRequestError(413)
            return None
        method, target, old, headers = _head_of(bytes(head))
        length = _length_of(headers)
        whole = len(head) + len(_END) + length
        if len(self._bytes) < whole:
            return None
        body = bytes(self._bytes[whole - length : whole])
        del self._bytes[:whole]
        return Request(method, target, headers, body, old)

    def rest(self) -> bytes:
        """Return what came behind the last request, and forget it."""
        data = bytes(self._bytes)
        self._bytes.clear()
        return data


def _head_of(head: bytes) -> tuple[str, str, bool, dict[str, str]]:
    first, *lines = head.lstrip(b"\r\n").split(b"\r\n")
    found = _LINE.fullmatch(first)
    if found is None or len(head) > LONGEST_HEAD_BYTES:
        raise BadRequestError(400)
    headers: dict[str, str] = {}
    for line in lines:
        name, colon, value = line.decode("latin-1").partition(":")
        if not colon or not name.strip():
            raise BadRequestError(400)
        headers[name.strip().lower()] = value.strip()
    return found[1].decode(), found[2].decode("latin-1"), found[3] == b"0", headers


def _length_of(headers: Mapping[str, str]) -> int:
    if "transfer-encoding" in headers:
        raise BadRequestError(411)
    text = headers.get("content-length", "0")
    if not text.isascii() or not text.isdecimal():
        raise BadRequestError(400)
    if len(text) > len(str(LONGEST_BODY_BYTES)) or int(text) > LONGEST_BODY_BYTES:
        raise BadRequestError(413)
    return int(text)
