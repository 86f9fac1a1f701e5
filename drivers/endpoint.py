"""Endpoints as the cell file writes them, and the transports that lead there."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal
from urllib.parse import SplitResult, parse_qsl, urlsplit

from drivers.errors import LinkError
from drivers.record import RecordingTransport, Sink
from drivers.tcp import TcpTransport
from drivers.transport import Transport

Parity = Literal["N", "E", "O"]
StopBits = Literal["1", "1.5", "2"]

_FORMS = "write tcp://host:port or serial:///dev/ttyUSB0?baud=9600&parity=E&stopbits=2"
_PARITIES: dict[str, Parity] = {"N": "N", "E": "E", "O": "O"}
_STOP_BITS: dict[str, StopBits] = {"1": "1", "1.5": "1.5", "2": "2"}


@dataclass(frozen=True)
class TcpEndpoint:
    """A listening socket.

    Attributes:
        host: name or address.
        port: 1...65535.
    """

    host: str
    port: int

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"tcp://{host}:{self.port}"


@dataclass(frozen=True)
class SerialEndpoint:
    """A serial line.

    Attributes:
        device: path of the port.
        baud: symbols a second.
        parity: none, even or odd.
        stopbits: stop bits.
    """

    device: str
    baud: int = 9600
    parity: Parity = "N"
    stopbits: StopBits = "1"

    def __str__(self) -> str:
        return f"serial://{self.device}?baud={self.baud}&parity={self.parity}&stopbits={self.stopbits}"


def parse_endpoint(text: str) -> TcpEndpoint | SerialEndpoint:
    """Read an endpoint.

    Args:
        text: `tcp://host:port` or `serial:///device?baud=..&parity=N|E|O&stopbits=1|1.5|2`.

    Raises:
        ValueError: the text is no endpoint; the message names the fault and shows the forms.
    """
    try:
        parts = urlsplit(text)
    except ValueError as exc:
        raise ValueError(f"endpoint {text!r}: {exc}; {_FORMS}") from None
    match parts.scheme:
        case "tcp":
            return _parse_tcp(text, parts)
        case "serial":
            return _parse_serial(text, parts)
        case other:
            raise ValueError(f"endpoint {text!r}: unknown kind {other!r}; {_FORMS}")


def _parse_tcp(text: str, parts: SplitResult) -> TcpEndpoint:
    try:
        port = parts.port
    except ValueError:
        port = None
    if not parts.hostname:
        raise ValueError(f"endpoint {text!r}: the host is missing; {_FORMS}")
    if not port:
        raise ValueError(f"endpoint {text!r}: the port must be a number from 1 to 65535; {_FORMS}")
    if parts.path or parts.query or parts.fragment or parts.username:
        raise ValueError(f"endpoint {text!r}: nothing may follow the port nor precede the host; {_FORMS}")
    return TcpEndpoint(parts.hostname, port)


def _parse_serial(text: str, parts: SplitResult) -> SerialEndpoint:
    if parts.netloc or parts.path in {"", "/"}:
        raise ValueError(f"endpoint {text!r}: the device path must follow serial:// ; {_FORMS}")
    values = dict(parse_qsl(parts.query, keep_blank_values=True))
    known = {"baud": "9600", "parity": "N", "stopbits": "1"}
    if unknown := values.keys() - known.keys():
        raise ValueError(f"endpoint {text!r}: unknown setting {min(unknown)!r}; known are {_words(known)}")
    values = known | values
    if not values["baud"].isdecimal() or not int(values["baud"]):
        raise ValueError(f"endpoint {text!r}: baud must be a positive integer, got {values['baud']!r}")
    if values["parity"] not in _PARITIES:
        raise ValueError(f"endpoint {text!r}: parity must be one of N, E, O, got {values['parity']!r}")
    if values["stopbits"] not in _STOP_BITS:
        raise ValueError(f"endpoint {text!r}: stopbits must be one of 1, 1.5, 2, got {values['stopbits']!r}")
    return SerialEndpoint(
        parts.path,
        int(values["baud"]),
        _PARITIES[values["parity"]],
        _STOP_BITS[values["stopbits"]],
    )


def _words(names: Iterable[str]) -> str:
    return ", ".join(names)


def require_tcp(text: str) -> TcpEndpoint:
    """Read an endpoint that has to be a socket.

    Raises:
        LinkError: it is no endpoint, or a serial line; the text says what to use instead.
    """
    try:
        endpoint = parse_endpoint(text)
    except ValueError as exc:
        raise LinkError(str(exc)) from None
    if isinstance(endpoint, SerialEndpoint):
        raise LinkError(
            f"{endpoint}: serial links come with a later version; "
            "use tcp://host:port, for a serial device through a serial device server"
        )
    return endpoint


def open_transport(text: str, *, connect_timeout_s: float = 5.0, sink: Sink | None = None) -> Transport:
    """Return the transport of an endpoint, not yet connected.

    Args:
        text: the endpoint as in the cell file.
        connect_timeout_s: how long connecting may take, s.
        sink: is called with all bytes that pass, when given.

    Raises:
        LinkError: the endpoint is wrong or of a kind that is not available.
    """
    endpoint = require_tcp(text)
    transport = TcpTransport(endpoint.host, endpoint.port, connect_timeout_s=connect_timeout_s)
    return RecordingTransport(transport, sink) if sink else transport
