r"""Data link: what the program CATSDL that the product ships does on a controller, without an interpreter.

Records of ASCII go both ways, `id,command,a,b,c,d` and a CR (sheet, section 4.1). Joints are J1 deg, J2 deg, J3 mm,
J4 deg.

=======  =============================================  ======================================================
command  a, b, c, d                                     answer
=======  =============================================  ======================================================
1        a via point                                    ``id,1,<points in the queue>,0,0,0``; ``id,-2,3120,0,0,0``
                                                        when there are 60
2        –                                              drives them, ``Cnt 1`` at all but the last; after the
                                                        standstill ``id,2,<feedback>``
3        –                                              ``id,3,<feedback>``
4        –                                              forgets the points, ``id,4,0,0,0,0``
5        –                                              ``id,5,1,4,0,1``: version 1, four joints, an EMULATOR
                                                        (a real controller says 0 in the last place)
6        override in per cent, in-position pulses       ``id,6,a,b,0,0``
7        –                                              ``id,7,0,0,0,0``, the program ends
other    –                                              ``id,-1,<command>,0,0,0``
=======  =============================================  ======================================================

As on a controller, what goes wrong in a statement is an alarm that halts the program, and no answer comes: a record
that is not six numbers L3500, a point outside the joint limits L2602 (already at the start of the drive, which is
earlier than on a controller), a drive with the servo off L2000, an override out of range L3110. STOP halts it too.
RUN lets it go on, straight to the last point; after RSTPRG or SLOTINIT it begins anew, with RUN or the next
connection. Requests that come during a drive wait. One client is served at a time, a second one waits.

The program ends by command 7 without closing the connection; the client closes it. Feedback (`J_Fbc`) is what the
encoders on the motors read, before the gears' errors, in float32. How `Print #` writes numbers is unknown: the option
`number_format` chooses. `Fine` changes nothing here: the answer comes 0.05 s after the standstill.
"""

import re
import struct
from collections import deque
from collections.abc import Callable
from typing import Literal

from catseye.simulators.config import Joints
from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.arm_control import ArmControl, Run
from catseye.simulators.melfa.resident import Resident
from catseye.simulators.melfa.values import rounded, within_limits
from catseye.simulators.ports.session import Answer, Pending, Session
from catseye.simulators.world.motion import blend

NumberFormat = Literal["plain", "fixed", "exponent"]
"""How numbers are printed: `12.3457`, `+12.346` and `1.2345670E+01`."""

LONGEST_RECORD = 255
MOST_POINTS = 60

_FORMATS: dict[NumberFormat, str] = {"plain": "{:.6g}", "fixed": "{:+.3f}", "exponent": "{:.7E}"}
_NUMBER = re.compile(rb"\s*[+-]?(\d+(?:\.\d*)?|\.\d+)([Ee][+-]?\d{1,2})?\s*")
_MOST_WAITING = 128
_DWELL_S = 0.05
_LATER_S = 60.0
_FLOAT = struct.Struct("<f")

Record = tuple[float, ...]
"""Six numbers."""


class Datalink(Resident):
    """The program that serves the data link while it runs."""

    def __init__(
        self, controller: ArmControl, name: str = "CATSDL", number_format: NumberFormat = "plain"
    ) -> None:
        super().__init__(name, controller.require_start, controller.changed)
        self.controller = controller
        self.client: DatalinkSession | None = None
        self._format = _FORMATS[number_format]
        self._points: list[Joints] = []
        self._percent = 100.0
        self._run: Run | None = None
        self.turn = 0

    @property
    def busy(self) -> bool:
        """It drives the arm."""
        return self._run is not None

    def begin(self) -> None:
        """Forget points, override and drive."""
        self._points, self._run, self._percent = [], None, 100.0
        self.turn += 1

    def go_on(self) -> None:
        """Drive on to the last point."""
        if self._run is not None:
            self._run = self._drive([self._run.target])

    def carry_out(self, record: Record) -> bytes | Run:
        """Carry out a request; return its answer, or the drive at whose end it is to be answered.

        Raises:
            Refusal: the program halts with this alarm.
        """
        number, command, *values = record
        handlers: dict[float, Callable[[float, list[float]], bytes | Run]] = {
            1: self._add,
            2: self._start,
            3: self._read,
            4: self._forget,
            5: self._identify,
            6: self._set_speed,
            7: self._finish,
        }
        handler = handlers.get(command)
        return _record(number, -1, f"{command:g}") if handler is None else handler(number, values)

    def arrived(self, number: float) -> bytes:
        """Return the answer to a drive that is over."""
        self._run = None
        return self._feedback(number, 2)

    def time_left_s(self) -> float | None:
        """Return the bench time at which the drive is over, None when it is."""
        now_s = self.controller.bench.time_s
        if not self.running:
            return now_s + _LATER_S
        end_s = now_s if self._run is None else self._run.end_s + _DWELL_S
        return end_s if now_s < end_s else None

    def _add(self, number: float, values: list[float]) -> bytes:
        if len(self._points) >= MOST_POINTS:
            return _record(number, -2, str(alarms.COUNT))
        j1, j2, j3, j4 = values
        self._points.append(rounded((j1, j2, j3, j4)))
        return _record(number, 1, str(len(self._points)))

    def _start(self, number: float, values: list[float]) -> bytes | Run:
        del values
        if not self._points:
            return self._feedback(number, 2)
        points, self._points = self._points, []
        self._run = self._drive(points)
        return self._run

    def _drive(self, points: list[Joints]) -> Run:
        controller = self.controller
        controller.require_ready()
        if not within_limits(points, controller.config).all():
            raise Refusal(alarms.DESTINATION_OUT_OF_RANGE)
        speed = controller.override_percent * self._percent * controller.joint_override_percent / 1e6
        here = controller.arm.joints
        times_s, knots = blend([here, *points], controller.config.dynamics, speed)
        return controller.follow(times_s, knots, points[-1])

    def _read(self, number: float, values: list[float]) -> bytes:
        del values
        return self._feedback(number, 3)

    def _forget(self, number: float, values: list[float]) -> bytes:
        del values
        self._points = []
        return _record(number, 4)

    def _identify(self, number: float, values: list[float]) -> bytes:
        del values
        return _record(number, 5, "1", "4", "0", "1")

    def _set_speed(self, number: float, values: list[float]) -> bytes:
        percent, pulses, *_ = values
        if not 0.0 < percent <= 100.0 or pulses < 0.0:
            raise Refusal(alarms.OUT_OF_RANGE)
        self._percent = percent
        return _record(number, 6, self._printed(percent), self._printed(pulses))

    def _finish(self, number: float, values: list[float]) -> bytes:
        del values
        self.reset()
        return _record(number, 7)

    def _feedback(self, number: float, command: int) -> bytes:
        return _record(number, command, *map(self._printed, self.controller.feedback))

    def _printed(self, value: float) -> str:
        return self._format.format(_FLOAT.unpack(_FLOAT.pack(value))[0])


def _record(number: float, command: int, *fields: str) -> bytes:
    four = (*fields, "0", "0", "0", "0")[:4]
    return f"{number:.0f},{command},{','.join(four)}\r".encode("ascii")


class DatalinkSession(Session):
    """Conversation with one client.

    Args:
        program: what all clients of the port wait for.
        note: called with each request.
    """

    def __init__(self, program: Datalink, note: Callable[[str], None]) -> None:
        self._program = program
        self._note = note
        self._bytes = bytearray()
        self._records: deque[bytes] = deque(maxlen=_MOST_WAITING)
        self._take_place()

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere; a LF beside the CR is ignored."""
        self._bytes += data.replace(b"\n", b"")
        *whole, rest = self._bytes.split(b"\r")
        self._records.extend(bytes(line[: LONGEST_RECORD + 1]) for line in whole)
        # What is too long already will not become a record; enough is kept to refuse it.
        self._bytes = rest[: LONGEST_RECORD + 1]

    def answer(self) -> Answer | None:
        """Carry out the next record, as soon as the program runs and has time for this client."""
        if not self._records:
            return None
        if not self._served:
            return Pending(self._until_served, lambda: b"")
        record = self._records.popleft()
        self._note(record.decode("latin-1"))
        try:
            done = self._program.carry_out(parse(record))
        except Refusal as refusal:
            self._program.controller.raise_alarm(refusal.number)
            return b""
        if isinstance(done, Run):
            return self._when_arrived(record)
        return done

    def close(self) -> None:
        """Leave the place to the next client; a drive under way goes on."""
        self._records.clear()
        if self._program.client is self:
            self._program.client = None
            self._program.controller.changed()

    @property
    def _served(self) -> bool:
        self._take_place()
        return self._program.client is self and self._program.running

    def _take_place(self) -> None:
        if self._program.client is None:
            self._program.client = self
            self._program.wake()

    def _until_served(self) -> float | None:
        return None if self._served else self._program.controller.bench.time_s + _LATER_S

    def _when_arrived(self, record: bytes) -> Pending:
        program, turn, number = self._program, self._program.turn, parse(record)[0]

        def due() -> float | None:
            return program.time_left_s() if program.turn == turn else None

        return Pending(due, lambda: program.arrived(number) if program.turn == turn else b"")


def parse(record: bytes) -> Record:
    """Read a request.

    Raises:
        Refusal: it is not six numbers.
    """
    fields = record.split(b",")
    if len(record) > LONGEST_RECORD or len(fields) != 6 or not all(map(_NUMBER.fullmatch, fields)):
        raise Refusal(alarms.BAD_INPUT)
    values = tuple(float(field) for field in fields)
    if not all(abs(value) < 1e9 for value in values):
        raise Refusal(alarms.BAD_INPUT)
    return values
