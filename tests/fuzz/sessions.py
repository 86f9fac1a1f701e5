"""Sessions of all emulators, and what clients say to them.

An emulator that is registered is tried by itself; `SAID` and `VALID` get its random bytes beyond the first one.
"""

import random
import struct
from collections.abc import Callable
from dataclasses import dataclass

from catseye.drivers.leica.codec import encode
from catseye.simulators.config import EmulatedDevice
from catseye.simulators.control_port.operations import ControlSession
from catseye.simulators.emulated_bench import EmulatedBench, ServedBench
from catseye.simulators.emulator import sessions_of
from catseye.simulators.ports.session import Pending, Session
from catseye.simulators.world.timed_bench import TimedBench
from tests.fuzz.decoders import JSON_SAYS
from tests.transcripts import attocube_ids, lasertex_hpi, melfa_datalink, melfa_mxt, melfa_r3
from tests.unit.simulators.abb.benches import abb_bench
from tests.unit.simulators.abb.test_server import Client
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.kuka.benches import kuka_bench

BACKLOG_BYTES = 65_536


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


SAID: dict[str, tuple[bytes, ...]] = {
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


def _proxied(kind: int, payload: bytes) -> bytes:
    return struct.pack(">HHB", 7, 1 + len(payload), kind) + payload


def _narrow(text: str) -> bytes:
    return struct.pack(">H", len(text)) + text.encode()


def _wide(text: str) -> bytes:
    return struct.pack(">H", len(text)) + text.encode("utf-16-le")


def _modbus(pdu: bytes) -> bytes:
    return struct.pack(">HHHB", 1, 0, len(pdu) + 1, 1) + pdu


_CONTROL = (
    '{"op": "state"}',
    '{"op": "truth"}',
    '{"op": "log"}',
    '{"op": "optics"}',
    '{"op": "survey"}',
    '{"op": "speed", "speed": 10.0}',
    '{"op": "turn_screw", "screw": "horizontal", "turns": 0.1}',
    '{"op": "place_reflector", "reflector": "P1"}',
    '{"op": "fault", "name": "block_beam", "duration_s": 0.5}',
    '{"op": "fault", "name": "alarm", "number": 4140}',
    '{"op": "fault", "name": "air", "temperature_c": 21.0}',
    '{"op": "fault", "name": "lossy", "device": "robot", "share": 0.05}',
    '{"op": "fault", "name": "clear_faults"}',
    '{"op": "mount_angular_optics", "joint": "A1", "lever_mm": 300.0, "offset_mm": 0.0}',
)

_MELFA = tuple(
    b"1;1;" + exchange.request.encode() + b"\r"
    for exchange in vars(melfa_r3).values()
    if isinstance(exchange, melfa_r3.Exchange)
)

VALID: dict[str, tuple[bytes, ...]] = {
    "melfa-r3": (
        *_MELFA,
        b"1;1;CNTLON\r",
        b"1;1;SRVON\r",
        b"1;1;JOVRD10\r",
        b"1;1;EXECMOV (10.00,20.00,50.00,0.00)\r",
        b"1;1;JPOSF\r",
        b"1;1;STOP\r",
        b"1;1;SRVOFF\r",
    ),
    "melfa-datalink": (
        melfa_datalink.ADD,
        melfa_datalink.ASK_FEEDBACK,
        melfa_datalink.WHO,
        melfa_datalink.SPEED,
    ),
    "melfa-mxt": (melfa_mxt.WHERE, melfa_mxt.SET_POINT, melfa_mxt.END),
    "line-counter": (b"R\r\n", b"Z\r\n", b"S\r\n"),
    "heidenhain-nd": (b"\x1bA0200\r", b"\x1bT0000\r", b"\x1bA0000\r", b"\x1bA0100\r"),
    "kuka-varproxy": (
        _proxied(0, _narrow("$OV_PRO")),
        _proxied(1, _narrow("$OV_PRO") + _narrow("10")),
        _proxied(6, b"\x02" + _wide("$OV_PRO") + _wide("$AXIS_ACT")),
        _proxied(0, _narrow("CATS_GOAL")),
        _proxied(
            1, _narrow("CATS_GOAL") + _narrow("{E6AXIS: A1 1.0, A2 -90.0, A3 90.0, A4 0.0, A5 30.0, A6 0.0}")
        ),
    ),
    "lasertex-hpi": tuple(bytes.fromhex(frame) for frame in lasertex_hpi.COMMANDS.values()),
    "attocube-ids": (attocube_ids.NEWER_REQUEST, attocube_ids.OLDER_REQUEST),
    "modbus-air": (
        _modbus(b"\x03\x00\x00\x00\x04"),
        _modbus(b"\x04\x00\x00\x00\x04"),
        _modbus(b"\x2b\x0e\x01\x00"),
    ),
    "modbus-io": (
        _modbus(b"\x02\x00\x00\x00\x08"),
        _modbus(b"\x0f\x00\x00\x00\x08\x01\xff"),
        _modbus(b"\x2b\x0e\x01\x00"),
    ),
    "t2sa": (
        b"?STAT\r\n",
        b"?LSTA\r\n",
        b"!LST:1\r\n",
        b"!SET_SIM:1\r\n",
        b"!SET_WORKING_FRAME:base\r\n",
        b"!MEAS_SINGLE_POINT:A;b;world1\r\n",
        b"?POINT_POS:A;b;world1\r\n",
        b"?POS base\r\n",
        b"!HALT\r\n",
        b"!PUBLISH_ALT_AZ_ROT:1.0;2.0;3.0\r\n",
    ),
    "vaisala-ascii": (
        b"SEND\r",
        b"R\r",
        b"S\r",
        b"INTV 1 s\r",
        b'FORM 6.1 "P=" P " " U6 \\r \\n\r',
        b"UNIT M\r",
        b"?\r",
    ),
    "catseye-control": tuple(f"{request}\n".encode() for request in _CONTROL),
}  # fmt: skip - one request a line
VALID["leica-emscon"] = SAID["leica-emscon"]

SAID["catseye-control"] = (
    b'{"op": ',
    b'"fault"',
    b', "name": "air"',
    b"}\n",
    b"\n",
    b"[" * 3000,
    b"9" * 5000,
)


@dataclass(frozen=True)
class Served:
    """A session of an emulator, ready for anything.

    Attributes:
        feed: takes the bytes, and advances bench time.
        close: ends the session.
        pieces: of what clients say, in any order.
        valid: whole requests, which are mutated.
    """

    feed: Callable[[bytes], None]
    close: Callable[[], None]
    pieces: tuple[bytes, ...]
    valid: tuple[bytes, ...]


OF_SERIAL_ARMS: dict[str, Callable[[], ServedBench]] = {
    "kuka-varproxy": kuka_bench,
    "abb-rws": abb_bench,
    "leica-emscon": kuka_bench,
    "t2sa": kuka_bench,
}
"""Benches of robots that move another arm, and of trackers that look at one."""

CONTROL = "catseye-control"


def served(protocol: str, endpoint: str) -> Served:
    """Return a session of an emulator on a bench of its own.

    Args:
        protocol: of the emulator, or `catseye-control`.
        endpoint: on a serial line some frame their requests in another way.
    """
    emulation = OF_SERIAL_ARMS.get(protocol, lambda: EmulatedBench(QUIET))()
    if isinstance(emulation, EmulatedBench):
        # Programs of the controller serve their clients with the servo on.
        emulation.controller.switch_servo_on()
    emulation.context.bench.advance(2.0)
    valid = VALID.get(protocol, ())
    if protocol == CONTROL:
        session: Session = ControlSession(emulation.reach)
    elif protocol == "abb-rws":
        session, valid = _let_in()
    else:
        device = EmulatedDevice("device", protocol, endpoint)
        session = sessions_of(emulation.context, device, lambda _text: None)()
    conversation = Conversation(session, emulation.context.bench)
    return Served(conversation.feed, session.close, SAID.get(protocol, ()), valid)


def _let_in() -> tuple[Session, tuple[bytes, ...]]:
    """Return a session of a client that has proved who it is, and requests with its cookie."""
    client = Client(abb_bench())
    client.get("/rw/panel/opmode")
    requests = (
        ("GET", "/rw/panel/ctrlstate", ""),
        ("GET", "/rw/motionsystem/mechunits/ROB_1/jointtarget", ""),
        ("GET", "/rw/rapid/symbol/data/RAPID/T_ROB1/cats_seq", ""),
        ("POST", "/rw/rapid/symbol/data/RAPID/T_ROB1/cats_seq?action=set", "value=1"),
        ("POST", "/rw/rapid/execution?action=stop", "stopmode=stop"),
        ("POST", "/rw/panel/speedratio?action=setspeedratio", "speed-ratio=10"),
        ("GET", "/fileservice/%24HOME/cats/a.mod", ""),
        ("PUT", "/fileservice/%24HOME/cats/a.mod", "MODULE a"),
    )
    return client.session, tuple(
        f"{method} {target} HTTP/1.1\r\nHost: h\r\nCookie: {client.cookie}\r\n"
        f"Content-Length: {len(body)}\r\n\r\n{body}".encode()
        for method, target, body in requests
    )
