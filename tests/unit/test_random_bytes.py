"""A million bytes of nonsense: drivers raise ProtocolError only, emulators nothing, and nobody hangs or grows.

A new protocol needs one line in `DECODERS`; an emulator that is registered is tried by itself. Half of the bytes are
drawn at random, half are pieces of what the protocol says, in any order, so that the nonsense gets beyond the first
byte.
"""

import contextlib
import random
import tracemalloc
from collections.abc import Callable, Iterator

import pytest

from catseye.drivers.abb.http import AnswerDecoder as HttpDecoder
from catseye.drivers.air.ptu300_codec import TextDecoder
from catseye.drivers.attocube.codec import AnswerDecoder as IdsDecoder
from catseye.drivers.counter.codec import LineDecoder, StreamDecoder
from catseye.drivers.counter.profile import load_profile
from catseye.drivers.heidenhain.codec import ReplyDecoder
from catseye.drivers.kuka.codec import Kind
from catseye.drivers.kuka.codec import ReplyDecoder as VarproxyDecoder
from catseye.drivers.lasertex.codec import FrameDecoder as HpiDecoder
from catseye.drivers.leica.codec import RepliesDecoder, encode
from catseye.drivers.leica.codec import ReplyDecoder as EmsconDecoder
from catseye.drivers.leica.measurement import ResultDecoder
from catseye.drivers.links.link import Decoder
from catseye.drivers.links.stream import FrameDecoder
from catseye.drivers.melfa import codec as melfa
from catseye.drivers.melfa.datalink.codec import RecordDecoder
from catseye.drivers.melfa.mxt.codec import decode as decode_mxt
from catseye.drivers.roles.errors import ProtocolError
from catseye.drivers.t2sa.codec import ReplyDecoder as T2saDecoder
from catseye.drivers.tracker.bench_tracker import ObjectDecoder
from catseye.drivers.umd.codec import SampleDecoder
from catseye.simulators.config import EmulatedDevice
from catseye.simulators.emulated_bench import EmulatedBench, ServedBench
from catseye.simulators.emulator import emulator_names, sessions_of
from catseye.simulators.ports.session import Pending, Session
from catseye.simulators.world.timed_bench import TimedBench
from tests.unit.simulators.abb.benches import abb_bench
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.kuka.benches import kuka_bench

TOTAL_BYTES = 1_000_000
LONGEST_CHUNK = 700
BACKLOG_BYTES = 65_536
WATCHED_BYTES = 100_000
"""So many bytes at the end are fed while memory is traced, which makes everything several times slower."""
MOST_HELD_BYTES = 50_000
"""More than any buffer of a codec; one that keeps half of the watched bytes, as they are or as objects, holds it."""

Feed = Callable[[bytes], None]


def answers(make: Callable[[], Decoder[object]]) -> Feed:
    """Return what feeds decoders of answers, each until it has its answer or gives up."""
    decoder = make()

    def feed(data: bytes) -> None:
        nonlocal decoder
        try:
            done = decoder.feed(data) is not None
            if not done and decoder.may_end:
                decoder.end()
                done = True
        except ProtocolError:
            done = True
        if done:
            decoder = make()

    return feed


def stream(decoder: FrameDecoder[object]) -> Feed:
    """Return what feeds the decoder of a stream, which nothing may throw off its track."""

    def feed(data: bytes) -> None:
        decoder.feed(data)

    return feed


def datagrams(decode: Callable[[bytes], object]) -> Feed:
    """Return what feeds a codec of datagrams, each chunk as one."""

    def feed(data: bytes) -> None:
        with contextlib.suppress(ProtocolError):
            decode(data)

    return feed


def melfa_answers(layout: melfa.Layout) -> Feed:
    return answers(lambda: melfa.AnswerDecoder(layout))


PROFILE = load_profile("default")
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

DECODERS: dict[str, tuple[Callable[[], Feed], tuple[bytes, ...]]] = {
    "melfa-r3 bare": (lambda: melfa_answers(melfa.bare), MELFA_SAYS),
    "melfa-r3 open": (lambda: melfa_answers(melfa.open_text), MELFA_SAYS),
    "melfa-r3 state": (lambda: melfa_answers(melfa.state_text), MELFA_SAYS),
    "melfa-r3 positions": (lambda: melfa_answers(melfa.positions_text), MELFA_SAYS),
    "melfa-r3 error": (lambda: melfa_answers(melfa.error_text), MELFA_SAYS),
    "melfa-r3 free": (lambda: melfa_answers(melfa.free_text), MELFA_SAYS),
    "melfa-datalink": (lambda: answers(RecordDecoder), (b"OK", b"ER", b",", b"1.5", b"-", b"\r", b"(")),
    "melfa-mxt": (lambda: datagrams(decode_mxt), (bytes(196), b"\x00\x00\x80\x7f", b"\x01\x00")),
    "line-counter": (
        lambda: answers(lambda: LineDecoder(PROFILE, "R")),
        (b"+000012.345678 mm", b"OK", b"E01", b"R", b"\r", b"\r\n", b"\x06", b"\x15"),
    ),
    "line-counter stream": (lambda: stream(StreamDecoder(PROFILE)), (b"+1.5 mm", b"E01", b"\r\n", b"\x15")),
    "heidenhain-nd": (
        lambda: answers(ReplyDecoder),
        (b"\x06", b"\x15", b"\x02", b"+ 12.3456", b"\r\n", b"R"),
    ),
    "kuka-varproxy": (lambda: answers(lambda: VarproxyDecoder(1, Kind.READ)), VARPROXY_SAYS),
    "kuka-varproxy many": (lambda: answers(lambda: VarproxyDecoder(1, Kind.READ_MANY)), VARPROXY_SAYS),
    "abb-rws": (
        lambda: answers(HttpDecoder),
        (
            b"HTTP/1.1 200 OK\r\n",
            b"Content-Length: 9\r\n",
            b"\r\n",
            b"Transfer-Encoding: chunked\r\n",
            b"a\r\n",
            b"0",
        ),
    ),
    "lasertex-hpi": (lambda: stream(HpiDecoder()), (b"\xaa", b"\xaa\xb0\x15", b"\xb0\x0a", bytes(12))),
    "attocube-ids": (lambda: answers(lambda: IdsDecoder(1)), JSON_SAYS),
    "umd": (
        lambda: stream(SampleDecoder()),
        (b"1 ", b"-32768 ", b"4294967296 ", b"\r\n", b"1 2 3 4 5 6 7 8\n"),
    ),
    "vaisala-ascii": (lambda: answers(TextDecoder), (b"P= 1013.2 hPa", b"T= ***", b">", b"\r\n", b"SEND")),
    "leica-emscon": (lambda: answers(lambda: EmsconDecoder(1)), EMSCON_SAYS),
    "leica-emscon many": (lambda: answers(lambda: RepliesDecoder(1)), EMSCON_SAYS),
    "leica-emscon result": (lambda: answers(ResultDecoder), EMSCON_SAYS),
    "t2sa": (lambda: answers(T2saDecoder), (b"ACK-300 ", b"ERR-201", b" result 1,2,3 True", b"\r\n", b";")),
    "bench-tracker": (
        lambda: answers(ObjectDecoder),
        (b'{"ok": true', b', "x_mm": 1.0', b"}\n", b"[", b"\n"),
    ),
}


class Conversation:
    """Feeds a session as a port does: one answer after the other, silences and outputs in between.

    Args:
        session: of the client.
        bench: gives pending answers their time.
    """

    def __init__(self, session: Session, bench: TimedBench) -> None:
        self._session = session
        self._bench = bench
        self._source = random.Random(5)
        self._pending: Pending | None = None
        self._backlog_bytes = 0

    def feed(self, data: bytes) -> None:
        """Feed a chunk; a port leaves the bytes in the socket while a busy session has a backlog."""
        if self._backlog_bytes < BACKLOG_BYTES:
            self._session.feed(data)
            self._backlog_bytes += len(data)
        self._take()
        if self._pending is None and self._session.silence_s() is not None and self._source.random() < 0.3:
            self._session.idle()
            self._take()
        if self._session.next_output_s() is not None:
            assert isinstance(self._session.output(), bytes)

    def _take(self) -> None:
        while (answer := self._pending or self._session.answer()) is not None:
            if isinstance(answer, Pending):
                self._pending = answer
                if not self._is_due(answer):
                    return
                self._pending = None
                answer = answer.reply()
            assert isinstance(answer, bytes)
        self._backlog_bytes = 0

    def _is_due(self, pending: Pending) -> bool:
        """Let bench time pass; what waits for something else than time is not due."""
        for _ in range(2):
            due_s = pending.due()
            if due_s is None:
                return True
            if due_s > self._bench.time_s + 100.0:
                break
            self._bench.advance_to(due_s)
        return False


SAID_TO_EMULATORS: dict[str, tuple[bytes, ...]] = {
    "melfa-r3": (
        b"1;1;",
        b"EXEC",
        b"STATE",
        b"VAL=",
        b"PNR",
        b"EXEC2=MOV (",
        b"1,2,3",
        b")",
        b"=",
        b"\r",
        b";",
    ),
    "melfa-datalink": (b"1,", b"2.5,", b"-", b"(", b")", b"\r", b"\r\n"),
    "line-counter": (b"R", b"Z", b"B100", b"H", b"E1", b"\r", b"\n"),
    "heidenhain-nd": (b"\x1b", b"A0", b"A0200", b"T0", b"T0000", b"\x02", b"\r"),
    "kuka-varproxy": (
        b"\x00\x01\x00\x0a\x00\x00\x07$OV_PRO",
        b"\x00\x02\x00\x0d\x01\x00\x07$OV_PRO\x00\x01",
        b"\x00\x03\x00\x02\x06\xff",
        b"\x00\x04\x00\x00",
        b"$",
    ),
    "abb-rws": (
        b"GET /rw/panel/opmode HTTP/1.1\r\n",
        b"POST / HTTP/1.1\r\n",
        b"Content-Length: 9\r\n",
        b"\r\n",
        b"x",
    ),
    "lasertex-hpi": (b"\xaa", b"\xaa\xb0\x32", b"\xb0\x48", bytes(4)),
    "attocube-ids": (
        *JSON_SAYS,
        b'"method":"com.attocube.ids.displacement.getAxisDisplacement",',
        b'"params":[0],',
    ),
    "modbus-air": (b"\x00\x01\x00\x00\x00\x06\x01", b"\x03\x00\x00\x00\x02", b"\x10", b"\x2b\x0e\x01\x00"),
    "leica-emscon": (
        encode(1),
        encode(7),
        encode(26, "i", 0),
        encode(30, "4i", 10, 3, 0, 0),
        encode(24, "i", 1),
        encode(47, "9i", 2, 0, 0, 1, 1, 1, 0, 1, 0),
        encode(49),
        encode(55, "3di", 1.0, 2.0, 3.0, 1),
    ),
    "t2sa": (b"?POS ", b"!MEAS_SINGLE_POINT:A;b;world1", b"!CMDEXE:base", b"?STAT", b"\r\n", b";", b":1"),
    "vaisala-ascii": (b"SEND", b"R", b"S", b"INTV 1 s", b"\r", b"\r\n", b" "),
}


def nonsense(seed: int, pieces: tuple[bytes, ...]) -> Iterator[bytes]:
    """Yield a million bytes in chunks of any length."""
    source = random.Random(seed)
    left = TOTAL_BYTES
    while left > 0:
        size = source.choice((1, 2, 7, 60, LONGEST_CHUNK))
        if pieces and source.random() < 0.5:
            chunk = b"".join(source.choices(pieces, k=size // 4 + 1))[:LONGEST_CHUNK]
        else:
            chunk = source.randbytes(source.randint(1, size))
        left -= len(chunk)
        yield chunk


def survive(feed: Feed, pieces: tuple[bytes, ...]) -> None:
    """Feed a million bytes and see that hardly anything of them is kept."""
    chunks = nonsense(20260102, pieces)
    fed_bytes = 0
    while fed_bytes < TOTAL_BYTES - WATCHED_BYTES:
        chunk = next(chunks)
        feed(chunk)
        fed_bytes += len(chunk)
    last = list(chunks)
    tracemalloc.start()
    try:
        for chunk in last:
            feed(chunk)
        held, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert held < MOST_HELD_BYTES


@pytest.mark.parametrize("protocol", DECODERS)
def test_no_bytes_break_a_driver(protocol: str) -> None:
    make, pieces = DECODERS[protocol]
    survive(make(), pieces)


OF_SERIAL_ARMS: dict[str, Callable[[], ServedBench]] = {
    "kuka-varproxy": kuka_bench,
    "abb-rws": abb_bench,
    "leica-emscon": kuka_bench,
    "t2sa": kuka_bench,
}
"""Benches of robots that move another arm, and of trackers that look at one."""

SOCKET, LINE = "tcp://127.0.0.1:0", "serial:///dev/ptmx"
OTHER_ON_A_LINE = ("melfa-r3", "modbus-air")
"""Protocols that frame their requests in another way on a serial line."""


@pytest.mark.parametrize(
    ("protocol", "endpoint"), [(p, SOCKET) for p in emulator_names()] + [(p, LINE) for p in OTHER_ON_A_LINE]
)
def test_no_bytes_break_an_emulator(protocol: str, endpoint: str) -> None:
    emulation = OF_SERIAL_ARMS.get(protocol, lambda: EmulatedBench(QUIET))()
    device = EmulatedDevice("device", protocol, endpoint)
    session = sessions_of(emulation.context, device, lambda _text: None)()
    if isinstance(emulation, EmulatedBench):
        # Programs of the controller serve their clients with the servo on.
        emulation.controller.switch_servo_on()
    emulation.context.bench.advance(2.0)
    survive(Conversation(session, emulation.context.bench).feed, SAID_TO_EMULATORS.get(protocol, ()))
    session.close()
