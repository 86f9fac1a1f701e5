"""The decoders of all drivers, what each reads from an answer afterwards, and valid answers.

A new protocol needs one line in `DECODERS`.
"""

import contextlib
import struct
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

from catseye.drivers.abb import values as abb
from catseye.drivers.abb.http import Answer as HttpAnswer
from catseye.drivers.abb.http import AnswerDecoder as HttpDecoder
from catseye.drivers.air import ptu300_codec as vaisala
from catseye.drivers.attocube.codec import AnswerDecoder as IdsDecoder
from catseye.drivers.counter import codec as counter
from catseye.drivers.counter.profile import load_profile
from catseye.drivers.heidenhain import codec as heidenhain
from catseye.drivers.kuka import values as kuka
from catseye.drivers.kuka.codec import Kind
from catseye.drivers.kuka.codec import Reply as KukaReply
from catseye.drivers.kuka.codec import ReplyDecoder as VarproxyDecoder
from catseye.drivers.lasertex import codec as lasertex
from catseye.drivers.leica.codec import RepliesDecoder, name_of
from catseye.drivers.leica.codec import Reply as EmsconReply
from catseye.drivers.leica.codec import ReplyDecoder as EmsconDecoder
from catseye.drivers.leica.measurement import ResultDecoder
from catseye.drivers.links.link import Decoder
from catseye.drivers.links.stream import FrameDecoder
from catseye.drivers.melfa import codec as melfa
from catseye.drivers.melfa import texts
from catseye.drivers.melfa.datalink import codec as datalink
from catseye.drivers.melfa.mxt.codec import decode as decode_mxt
from catseye.drivers.modbus import codec as modbus
from catseye.drivers.roles.errors import ProtocolError
from catseye.drivers.t2sa import codec as t2sa
from catseye.drivers.tracker.bench_tracker import ObjectDecoder
from catseye.drivers.umd.codec import SampleDecoder
from tests.transcripts import (
    attocube_ids,
    heidenhain_nd,
    lasertex_hpi,
    line_counter,
    melfa_datalink,
    melfa_mxt,
    melfa_r3,
    umd,
    vaisala_ptu300,
)

Feed = Callable[[bytes], None]

PROFILE = load_profile("default")


@dataclass(frozen=True)
class Tried:
    """What is fed to one decoder.

    Attributes:
        make: makes what takes the bytes.
        pieces: of what the protocol says, in any order.
        valid: whole answers, which are mutated.
    """

    make: Callable[[], Feed]
    pieces: tuple[bytes, ...]
    valid: tuple[bytes, ...]


def answers(make: Callable[[], Decoder[Any]], *readers: Callable[[Any], object]) -> Feed:
    """Return what feeds decoders of answers, each until it has its answer or gives up.

    Args:
        readers: each reads something from a whole answer, or refuses it by ProtocolError.
    """
    decoder = make()

    def feed(data: bytes) -> None:
        nonlocal decoder
        try:
            answer = decoder.feed(data)
            if answer is None and decoder.may_end:
                answer = decoder.end()
        except ProtocolError:
            decoder = make()
            return
        if answer is not None:
            decoder = make()
            for read in readers:
                with contextlib.suppress(ProtocolError):
                    read(answer)

    return feed


def stream(decoder: FrameDecoder[Any], *readers: Callable[[Any], object]) -> Feed:
    """Return what feeds the decoder of a stream, which nothing may throw off its track."""

    def feed(data: bytes) -> None:
        for frame in decoder.feed(data):
            for read in readers:
                with contextlib.suppress(ProtocolError):
                    read(frame)

    return feed


def datagrams(decode: Callable[[bytes], object]) -> Feed:
    """Return what feeds a codec of datagrams, each chunk as one."""

    def feed(data: bytes) -> None:
        with contextlib.suppress(ProtocolError):
            decode(data)

    return feed


_OF_PAYLOADS: Final[tuple[Callable[[str], object], ...]] = (
    melfa.parse_open,
    melfa.parse_state,
    melfa.parse_positions,
    melfa.parse_error,
    lambda text: melfa.parse_parameter(text, "RLNG"),
    lambda text: texts.parse_variable(text, "M1"),
    texts.parse_directory,
    texts.parse_log,
    texts.parse_stop_sources,
    lambda text: texts.parse_word(text, "IOSIGNAL"),
    texts.parse_encoders,
    texts.parse_currents,
    lambda text: texts.parse_parameter(text, "MEXTL"),
    texts.parse_date,
)


def melfa_answers(layout: melfa.Layout) -> Feed:
    readers = [partial(_of_payload, read) for read in _OF_PAYLOADS]
    return answers(lambda: melfa.AnswerDecoder(layout), *readers)


def _of_payload(read: Callable[[str], object], answer: melfa.Answer) -> object:
    return read(answer.payload)


def kuka_answers(kind: Kind) -> Feed:
    reads = (
        kuka.real_of,
        kuka.whole_of,
        kuka.flag_of,
        kuka.symbol_of,
        kuka.string_of,
        kuka.members_of,
        kuka.axes_of,
    )
    return answers(lambda: VarproxyDecoder(1, kind), *(partial(_of_items, read) for read in reads))


def _of_items(read: Callable[[str], object], reply: KukaReply) -> None:
    for item in reply.items:
        read(item.text)


def abb_answers() -> Feed:
    return answers(HttpDecoder, abb.states_of, _value_of_abb, abb.error_of)


def _value_of_abb(answer: HttpAnswer) -> float:
    return abb.number_of(abb.value_of(answer, "ctrlstate"))


def _numbers_of_emscon(reply: EmsconReply) -> None:
    reply.values("3di")
    name_of(reply.data)


def _of_heidenhain(lines: tuple[str, ...]) -> None:
    for line in lines:
        heidenhain.displayed_decimals(line)
        with contextlib.suppress(ProtocolError):
            heidenhain.parse_position(line, 4)
        heidenhain.parse_indicators(line)


def _of_t2sa(reply: t2sa.Reply) -> None:
    with contextlib.suppress(ProtocolError):
        t2sa.parse_point(reply.text)
    t2sa.parse_report(reply.text)


def _of_vaisala(line: str) -> None:
    vaisala.parse_values(line)
    vaisala.checked(line)


def _of_counter(text: str) -> None:
    with contextlib.suppress(ProtocolError):
        counter.parse_value(PROFILE.query.reply, text)
    if PROFILE.status is not None:
        counter.parse_bits(PROFILE.status, text)


MELFA_SAYS = (b"QoK", b"Qok", b"QeR", b"4220", b"00000", b";", b"J1;0.00;", b"REP;START;1;0", b"\r", b"\r\n")
JSON_SAYS = (b'{"id":1,', b'"jsonrpc":"2.0",', b'"result":[0,1]', b"}", b"[", b"\n", b"1e999", b"{")

VARPROXY_SAYS = (
    b"\x00\x01",
    b"\x00\x08",
    b"\x00",
    b"\x06\x02",
    b"\x00\x0550.00",
    b"5\x000\x00",
    b"\x00\x01\x01",
)

EMSCON_SAYS = (
    b"\x10\x00\x00\x00\x00\x00\x00\x00\x01\x00\x00\x00\x00\x00\x00\x00",
    b"\x10\x00\x00\x00\x00\x00\x00\x00\x31\x00\x00\x00\x00\x00\x00\x00",
    b"\x0c\x00\x00\x00\x08\x00\x00\x00\x1b\x00\x00\x00",
    b"\x9c\x00\x00\x00\x02\x00\x00\x00",
    bytes(36),
)

MODBUS_SAYS = (
    b"\x00\x01\x00\x00\x00",
    b"\x07\x11\x03\x04",
    b"\x11\x03\x04",
    b"\x11\x83\x02",
    b"\x2b\x0e\x01",
)

_MELFA = tuple(
    exchange.answer.encode() + b"\r"
    for exchange in vars(melfa_r3).values()
    if isinstance(exchange, melfa_r3.Exchange)
)


def _proxied(kind: int, payload: bytes) -> bytes:
    body = bytes([kind]) + payload + b"\x00\x01\x01"
    return struct.pack(">HH", 1, len(body)) + body


def _narrow(text: str) -> bytes:
    return struct.pack(">H", len(text)) + text.encode()


def _wide(text: str) -> bytes:
    return struct.pack(">H", len(text)) + text.encode("utf-16-le")


_AXES = "{E6AXIS: A1 0.0, A2 -90.0, A3 90.0, A4 0.0, A5 30.0, A6 0.0, E1 0.0, E2 0.0, E3 0.0, E4 0.0, E5 0.0, E6 0.0}"
_VARPROXY = tuple(_proxied(0, _narrow(text)) for text in ("50", "TRUE", "#P_ACTIVE", '"KRC4"', _AXES))
_VARPROXY_MANY = (_proxied(6, b"\x02\x01" + _wide("50") + b"\x01" + _wide(_AXES)),)

_JSON_BODY = b'{"_links":{"base":{"href":"http://h/rw/"}},"_embedded":{"_state":[{"_type":"pnl-ctrlstate","ctrlstate":"1"}]}}'
_HTTP = (
    b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: %d\r\n\r\n%s"
    % (len(_JSON_BODY), _JSON_BODY),
    b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n%x\r\n%s\r\n0\r\n\r\n"
    % (len(_JSON_BODY), _JSON_BODY),
    b"HTTP/1.1 400 Bad Request\r\nContent-Length: 65\r\n\r\n"
    b'{"_embedded":{"status":{"code":-1073445865,"msg":"not allowed"}}}',
    b"HTTP/1.1 204 No Content\r\n\r\n",
)  # fmt: skip - one answer a line

_EMSCON = (
    struct.pack("<iiii3di", 44, 0, 1, 0, 1.0, 2.0, 3.0, 1),
    struct.pack("<iiii", 16, 0, 1, 37),
    struct.pack("<iii", 12, 8, 26),
    struct.pack("<iiiii17d", 156, 2, 0, 0, 0, *range(17)),
    struct.pack("<iiiii23d", 204, 9, 0, 0, 0, *range(23)),
)

_MODBUS_PDUS = (
    b"\x03\x04\x7a\xe1\x41\xf4",
    b"\x83\x02",
    b"\x2b\x0e\x01\x01\x00\x00\x02\x00\x07Vaisala\x01\x06PTU300",
)
_MODBUS_TCP = tuple(struct.pack(">HHHB", 1, 0, len(pdu) + 1, 17) + pdu for pdu in _MODBUS_PDUS)
_MODBUS_RTU = tuple(b"\x11" + pdu + modbus.check_sum(b"\x11" + pdu) for pdu in _MODBUS_PDUS)


def modbus_answers(decoder: type[modbus.TcpDecoder | modbus.RtuDecoder], function: int) -> Feed:
    return answers(
        lambda: decoder(1, 17, function),
        modbus.exception_of,
        lambda answer: modbus.parse_registers(2, answer),
        lambda answer: modbus.parse_bits(2, answer),
        modbus.parse_objects,
    )


_UMD = (umd.ONE_AXIS, umd.THREE_AXES, umd.BEAM_LOST)
_LINES = (line_counter.AT_ZERO, line_counter.DONE, line_counter.READY, line_counter.BROKEN)
_JSON = (b'{"jsonrpc": "2.0", "result": [0, -1234567890], "id": 1}\r\n', attocube_ids.MODE_ANSWER)
_HPI = bytes.fromhex(lasertex_hpi.DISTANCE)
_ND = (
    heidenhain_nd.POSITION,
    heidenhain_nd.DISPLAYED,
    heidenhain_nd.IDENTITY,
    heidenhain_nd.INDICATORS,
    heidenhain_nd.ACKNOWLEDGED,
)

DECODERS: dict[str, Tried] = {
    "melfa-r3 bare": Tried(lambda: melfa_answers(melfa.bare), MELFA_SAYS, _MELFA),
    "melfa-r3 open": Tried(lambda: melfa_answers(melfa.open_text), MELFA_SAYS, _MELFA),
    "melfa-r3 state": Tried(lambda: melfa_answers(melfa.state_text), MELFA_SAYS, _MELFA),
    "melfa-r3 positions": Tried(lambda: melfa_answers(melfa.positions_text), MELFA_SAYS, _MELFA),
    "melfa-r3 error": Tried(lambda: melfa_answers(melfa.error_text), MELFA_SAYS, _MELFA),
    "melfa-r3 free": Tried(lambda: melfa_answers(melfa.free_text), MELFA_SAYS, _MELFA),
    "melfa-datalink": Tried(
        lambda: answers(datalink.RecordDecoder, datalink.joints_of),
        (b"OK", b"ER", b",", b"1.5", b"-", b"\r", b"("),
        (*melfa_datalink.ANSWERS.values(), melfa_datalink.ADDED, melfa_datalink.FULL),
    ),
    "melfa-mxt": Tried(
        lambda: datagrams(decode_mxt),
        (bytes(196), b"\x00\x00\x80\x7f", b"\x01\x00"),
        (melfa_mxt.AT_JOINTS, melfa_mxt.WHERE),
    ),
    "line-counter": Tried(
        lambda: answers(lambda: counter.LineDecoder(PROFILE, "R"), _of_counter),
        (b"+000012.345678 mm", b"OK", b"E01", b"R", b"\r", b"\r\n", b"\x06", b"\x15"),
        _LINES,
    ),
    "line-counter stream": Tried(
        lambda: stream(counter.StreamDecoder(PROFILE), _of_counter),
        (b"+1.5 mm", b"E01", b"\r\n", b"\x15"),
        _LINES,
    ),
    "heidenhain-nd": Tried(
        lambda: answers(heidenhain.ReplyDecoder, _of_heidenhain),
        (b"\x06", b"\x15", b"\x02", b"+ 12.3456", b"\r\n", b"R"),
        _ND,
    ),
    "kuka-varproxy": Tried(lambda: kuka_answers(Kind.READ), VARPROXY_SAYS, _VARPROXY),
    "kuka-varproxy many": Tried(lambda: kuka_answers(Kind.READ_MANY), VARPROXY_SAYS, _VARPROXY_MANY),
    "abb-rws": Tried(
        abb_answers,
        (
            b"HTTP/1.1 200 OK\r\n",
            b"Content-Length: 9\r\n",
            b"\r\n",
            b"Transfer-Encoding: chunked\r\n",
            b"a\r\n",
            b"0",
        ),
        _HTTP,
    ),
    "lasertex-hpi": Tried(
        lambda: stream(lasertex.FrameDecoder(), lasertex.parse_distance),
        (b"\xaa", b"\xaa\xb0\x15", b"\xb0\x0a", bytes(12)),
        (_HPI,),
    ),
    "attocube-ids": Tried(
        lambda: answers(lambda: IdsDecoder(1), lambda answer: answer.number(), lambda answer: answer.text()),
        JSON_SAYS,
        _JSON,
    ),
    "umd": Tried(
        lambda: stream(SampleDecoder()),
        (b"1 ", b"-32768 ", b"4294967296 ", b"\r\n", b"1 2 3 4 5 6 7 8\n", b"9" * 5000),
        _UMD,
    ),
    "vaisala-ascii": Tried(
        lambda: answers(vaisala.TextDecoder, _of_vaisala),
        (b"P= 1013.2 hPa", b"T= ***", b">", b"\r\n", b"SEND"),
        tuple(f"{line}\r\n".encode() for line in vaisala_ptu300.FORMATS.values()),
    ),
    "leica-emscon": Tried(
        lambda: answers(lambda: EmsconDecoder(1), _numbers_of_emscon), EMSCON_SAYS, _EMSCON
    ),
    "leica-emscon many": Tried(lambda: answers(lambda: RepliesDecoder(1)), EMSCON_SAYS, _EMSCON),
    "leica-emscon result": Tried(lambda: answers(ResultDecoder), EMSCON_SAYS, _EMSCON),
    "t2sa": Tried(
        lambda: answers(t2sa.ReplyDecoder, _of_t2sa),
        (b"ACK-300 ", b"ERR-201", b" result 1,2,3 True", b"\r\n", b";"),
        (
            b"ACK-300 READY\r\n",
            b"ERR-201 busy\r\n",
            b"ACK-300 Single Point Measurement A result 1.0,2.5,-3.0 m True\r\n",
            b"ACK-300 Object Offset Report B;X:1.0;Y:2.0;Z:3.0;Rx:0.1;Ry:0.2;Rz:0.3;\r\n",
        ),
    ),
    "bench-tracker": Tried(
        lambda: answers(ObjectDecoder),
        (b'{"ok": true', b', "x_mm": 1.0', b"}\n", b"[", b"\n"),
        (b'{"ok": true, "x_mm": 1.0, "y_mm": -2.5, "u_mm": 0.01}\n',),
    ),
    "modbus tcp": Tried(lambda: modbus_answers(modbus.TcpDecoder, 3), MODBUS_SAYS, _MODBUS_TCP),
    "modbus tcp identity": Tried(lambda: modbus_answers(modbus.TcpDecoder, 43), MODBUS_SAYS, _MODBUS_TCP),
    "modbus rtu": Tried(lambda: modbus_answers(modbus.RtuDecoder, 3), MODBUS_SAYS, _MODBUS_RTU),
    "modbus rtu identity": Tried(lambda: modbus_answers(modbus.RtuDecoder, 43), MODBUS_SAYS, _MODBUS_RTU),
}
