"""Endpoints as the cell file writes them, and the transports that lead there."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar, Literal
from urllib.parse import SplitResult, parse_qsl, urlsplit

from catseye.drivers.links.record import RecordingTransport
from catseye.drivers.links.serial_line import Handshake, LineSettings, Parity, SerialTransport, StopBits
from catseye.drivers.links.tcp import TcpTransport
from catseye.drivers.links.transport import Transport, socket_endpoint
from catseye.drivers.links.udp import UdpTransport
from catseye.drivers.roles.device import Sink
from catseye.drivers.roles.errors import LinkError

_FORMS = (
    "write tcp://host:port, udp://host:port or serial:///dev/ttyUSB0?baud=9600&parity=E&bits=8&stopbits=2"
)
_PARITIES: dict[str, Parity] = {"N": "N", "E": "E", "O": "O"}
_BITS: dict[str, Literal[7, 8]] = {"7": 7, "8": 8}
_STOP_BITS: dict[str, StopBits] = {"1": "1", "1.5": "1.5", "2": "2"}
_HANDSHAKES: dict[str, Handshake] = {"none": "none", "xonxoff": "xonxoff", "rtscts": "rtscts"}


@dataclass(frozen=True)
class _SocketEndpoint:
    scheme: ClassVar[str]
    host: str
    port: int

    def __str__(self) -> str:
        return socket_endpoint(self.scheme, self.host, self.port)


class TcpEndpoint(_SocketEndpoint):
    """A listening socket: name or address of its host, and its port, 1...65535."""

    scheme = "tcp"


class UdpEndpoint(_SocketEndpoint):
    """A datagram socket: name or address of its host, and its port, 1...65535."""

    scheme = "udp"


@dataclass(frozen=True)
class SerialEndpoint:
    """A serial line.

    Attributes:
        device: path of the port.
        baud: symbols a second.
        parity: none, even or odd.
        stopbits: stop bits.
        bits: data bits of a byte.
        handshake: none, by characters or by lines.
    """

    device: str
    baud: int = 9600
    parity: Parity = "N"
    stopbits: StopBits = "1"
    bits: Literal[7, 8] = 8
    handshake: Handshake = "none"

    @property
    def settings(self) -> LineSettings:
        """How bytes go over the line."""
        return LineSettings(self.baud, self.parity, self.bits, self.stopbits, self.handshake)

    def __str__(self) -> str:
        return f"serial://{self.device}?{self.settings.query}"


Endpoint = TcpEndpoint | UdpEndpoint | SerialEndpoint


def parse_endpoint(text: str) -> Endpoint:
    """Read an endpoint.

    Args:
        text: `tcp://host:port`, `udp://host:port` or
            `serial:///device?baud=..&parity=N|E|O&bits=7|8&stopbits=1|1.5|2&handshake=none|xonxoff|rtscts`.

    Raises:
        ValueError: the text is no endpoint; the message names the fault and shows the forms.
    """
    try:
        parts = urlsplit(text)
    except ValueError as exc:
        raise ValueError(f"endpoint {text!r}: {exc}; {_FORMS}") from None
    match parts.scheme:
        case "tcp":
            return TcpEndpoint(*_parse_socket(text, parts))
        case "udp":
            return UdpEndpoint(*_parse_socket(text, parts))
        case "serial":
            return _parse_serial(text, parts)
        case other:
            raise ValueError(f"endpoint {text!r}: unknown kind {other!r}; {_FORMS}")


def _parse_socket(text: str, parts: SplitResult) -> tuple[str, int]:
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
    return parts.hostname, port


def _parse_serial(text: str, parts: SplitResult) -> SerialEndpoint:
    if parts.netloc or parts.path in {"", "/"}:
        raise ValueError(f"endpoint {text!r}: the device path must follow serial:// ; {_FORMS}")
    values = dict(parse_qsl(parts.query, keep_blank_values=True))
    known = {"baud": "9600", "parity": "N", "bits": "8", "stopbits": "1", "handshake": "none"}
    if unknown := values.keys() - known.keys():
        raise ValueError(
            f"endpoint {text!r}: unknown setting {min(unknown)!r}; known are {_names_text(known)}"
        )
    values = known | values
    if not values["baud"].isdecimal() or not int(values["baud"]):
        raise ValueError(f"endpoint {text!r}: baud must be a positive integer, got {values['baud']!r}")
    choices: dict[str, Iterable[str]] = {
        "parity": _PARITIES,
        "bits": _BITS,
        "stopbits": _STOP_BITS,
        "handshake": _HANDSHAKES,
    }
    for key, allowed in choices.items():
        if values[key] not in allowed:
            raise ValueError(
                f"endpoint {text!r}: {key} must be one of {_names_text(allowed)}, got {values[key]!r}"
            )
    return SerialEndpoint(
        parts.path,
        int(values["baud"]),
        _PARITIES[values["parity"]],
        _STOP_BITS[values["stopbits"]],
        _BITS[values["bits"]],
        _HANDSHAKES[values["handshake"]],
    )


def _names_text(names: Iterable[str]) -> str:
    return ", ".join(names)


def require_stream(text: str) -> TcpEndpoint | SerialEndpoint:
    """Read an endpoint that has to be a TCP socket or a serial line.

    Raises:
        LinkError: it is no endpoint, or of another kind.
    """
    try:
        endpoint = parse_endpoint(text)
    except ValueError as exc:
        raise LinkError(str(exc)) from None
    if isinstance(endpoint, UdpEndpoint):
        raise LinkError(f"{endpoint}: this driver does not speak over datagrams: write tcp:// or serial://")
    return endpoint


def open_transport(text: str, *, connect_timeout_s: float = 5.0, sink: Sink | None = None) -> Transport:
    """Return the transport of an endpoint, not yet connected.

    Args:
        connect_timeout_s: how long connecting may take, s.
        sink: is called with all bytes that pass, when given.

    Raises:
        LinkError: the endpoint is wrong.
    """
    try:
        endpoint = parse_endpoint(text)
    except ValueError as exc:
        raise LinkError(str(exc)) from None
    transport: Transport
    match endpoint:
        case TcpEndpoint(host, port):
            transport = TcpTransport(host, port, connect_timeout_s=connect_timeout_s)
        case UdpEndpoint(host, port):
            transport = UdpTransport(host, port)
        case SerialEndpoint():
            transport = SerialTransport(endpoint.device, endpoint.settings, open_timeout_s=connect_timeout_s)
    return RecordingTransport(transport, sink) if sink else transport
