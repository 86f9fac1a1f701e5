"""Endpoints of emulators as the cell file writes them."""

from dataclasses import dataclass
from ipaddress import ip_address
from urllib.parse import SplitResult, parse_qsl, urlsplit

from catseye.simulators.errors import EmulatorError

_FORMS = (
    "emulators listen on tcp://HOST:PORT, udp://HOST:PORT (port 0 takes a free one) or "
    "serial:///PATH?baud=9600&parity=E&bits=8&stopbits=2 (a pseudo-terminal; /dev/ptmx takes a free one)"
)
_LINE: dict[str, tuple[str, ...]] = {
    "parity": ("N", "E", "O"),
    "bits": ("7", "8"),
    "stopbits": ("1", "1.5", "2"),
    "handshake": ("none", "xonxoff", "rtscts"),
}


@dataclass(frozen=True)
class SocketAddress:
    """Where a socket listens.

    Attributes:
        kind: tcp or udp.
        host: name or address.
        port: 0 takes a free one.
    """

    kind: str
    host: str
    port: int

    @property
    def is_loopback(self) -> bool:
        """Only programs of this computer get there."""
        try:
            return ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"

    def bound(self, port: int) -> str:
        """Return the endpoint with the port that is really used."""
        name = f"[{self.host}]" if ":" in self.host else self.host
        return f"{self.kind}://{name}:{port}"


@dataclass(frozen=True)
class LineAddress:
    """A serial line.

    Attributes:
        path: where clients find it; /dev/ptmx for any free pseudo-terminal.
        query: line settings as written, with the question mark; empty if there are none.
        byte_s: time of one byte on the line, s.
    """

    path: str
    query: str
    byte_s: float


def parse_address(device: str, endpoint: str) -> SocketAddress | LineAddress:
    """Read an endpoint.

    Raises:
        EmulatorError: it is none; the text shows the forms.
    """
    try:
        parts = urlsplit(endpoint)
        host, port = parts.hostname, parts.port
    except ValueError:
        raise EmulatorError(f"{device}: {_FORMS}, not on {endpoint!r}") from None
    if parts.scheme in {"tcp", "udp"} and host is not None and port is not None:
        return SocketAddress(parts.scheme, host, port)
    if parts.scheme == "serial" and not parts.netloc and parts.path.strip("/"):
        return _line(device, endpoint, parts)
    raise EmulatorError(f"{device}: {_FORMS}, not on {endpoint!r}")


def _line(device: str, endpoint: str, parts: SplitResult) -> LineAddress:
    given = dict(parse_qsl(parts.query, keep_blank_values=True))
    baud = given.pop("baud", "9600")
    if not baud.isdecimal() or int(baud) == 0:
        raise EmulatorError(f"{device}: {endpoint!r}: baud has to be a positive whole number, not {baud!r}")
    for key, value in given.items():
        if value not in _LINE.get(key, ()):
            known = "; ".join(f"{name} {', '.join(values)}" for name, values in _LINE.items())
            raise EmulatorError(f"{device}: {endpoint!r}: {key}={value} is unknown; known are {known}")
    parity_bits = given.get("parity", "N") != "N"
    symbols = 1 + int(given.get("bits", "8")) + parity_bits + float(given.get("stopbits", "1"))
    return LineAddress(parts.path, f"?{parts.query}" if parts.query else "", symbols / int(baud))
