"""One client of the emulated emScon server: its commands in turn, its measurement, and news that nobody asked for.

News and positions of the reflector are sent as the system settings say, to every client.
"""

import math
import struct
from collections import deque
from collections.abc import Callable

from catseye.simulators.leica import packets, parameters
from catseye.simulators.leica.packets import Command, CommandCutter
from catseye.simulators.leica.server import (
    BUSY,
    GO_AND_MEASURE,
    NO_NIVEL,
    NO_RESULT,
    OK,
    START,
    START_NIVEL,
    STOP,
    Job,
    Server,
)
from catseye.simulators.leica.stream import Stream
from catseye.simulators.ports.session import Answer, Session

TICK_S = 0.3
"""How often it is looked for news, bench time: the slowest of the rates that a server can be set to."""

_NIVEL_S = 1.0
_REFLECTORS = 42
_NOT_READY, _BUSY, _READY = 25, 26, 27
_COUNT_REACHED = 28


class EmsconSession(Session):
    """Conversation with one client.

    Args:
        note: called with each command.
    """

    def __init__(self, server: Server, note: Callable[[str], None], *, has_nivel: bool) -> None:
        self._server = server
        self._note = note
        self._has_nivel = has_nivel
        self._cutter = CommandCutter()
        self._commands: deque[Command] = deque()
        self._jobs: list[Job] = []
        self._stream: Stream | None = None
        self._told = server.news.count
        self._state = 0
        self._tick_s = server.now_s
        self._measurement: Job | None = None
        self._own: dict[int, Callable[[Command], bytes]] = {
            START: lambda command: self._start(command.number),
            STOP: lambda _command: self._stop(),
            START_NIVEL: lambda _command: self._start_nivel(),
            _REFLECTORS: lambda _command: server.information.reflectors(),
            GO_AND_MEASURE: self._go_and_measure,
        }

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere."""
        self._commands += self._cutter.feed(data)

    def answer(self) -> Answer | None:
        """Carry out the next command; packets of another type are passed over."""
        if not self._commands:
            return None
        command = self._commands.popleft()
        if command.kind != packets.COMMAND:
            return b""
        self._note(f"command {command.number}, {len(command.parameters)} bytes")
        if command.number in self._own:
            return self._own[command.number](command)
        said = self._server.carry_out(command)
        return said if isinstance(said, bytes) else self._later(said)

    def next_output_s(self) -> float | None:
        """Return when the next packet may be due."""
        due = [job.due_s for job in self._jobs]
        if self._stream is not None:
            due.append(self._stream.due_s)
        if self._listens:
            due.append(self._tick_s)
        return min(due, default=None)

    def output(self) -> bytes:
        """Return the packets that are due."""
        said = b"".join(job.said for job in self._jobs if job.done)
        self._jobs = [job for job in self._jobs if not job.done]
        if self._stream is not None:
            said += self._streamed(self._stream)
        if self._listens and self._server.now_s >= self._tick_s:
            self._tick_s = self._server.now_s + TICK_S
            said += self._news()
        return said

    def close(self) -> None:
        """End the measurement of this client."""
        if self._stream is not None:
            self._stream.stop()

    @property
    def _listens(self) -> bool:
        settings = self._server.kept[parameters.SETTINGS]
        return bool(settings[parameters.UNSOLICITED] or settings[parameters.REFLECTOR_POSITIONS])

    def _later(self, job: Job) -> bytes:
        self._jobs.append(job)
        return b""

    def _start(self, number: int) -> bytes:
        """Reply to the start of a measurement, and begin it."""
        server = self._server
        if refusal := server.refusal_to_measure(number):
            return refusal
        if self._stream is not None:
            return packets.reply(number, BUSY)
        if server.kept[parameters.MODE][0] != parameters.STATIONARY_MODE:
            self._stream = Stream(server)
            return packets.reply(number, OK)
        return self._measured_after(number, 0.0)

    def _measured_after(self, number: int, wait_s: float) -> bytes:
        """Begin a stationary measurement at a moment from now; return the reply that comes before its result."""
        duration_s = 1e-3 * self._server.kept[parameters.STATIONARY][0]
        self._measurement = self._server.begin(wait_s + duration_s, lambda: self._result(duration_s))
        return self._later(self._measurement) + packets.reply(number, OK)

    def _result(self, duration_s: float) -> bytes:
        server = self._server
        point = server.instrument.measure(duration_s)
        if point is None:
            server.last_status = NO_RESULT
            return packets.error(START, NO_RESULT)
        extended = bool(server.kept[parameters.STATISTIC][0])
        return packets.single(parameters.STATIONARY_MODE, point, server.instrument.air(), extended=extended)

    def _stop(self) -> bytes:
        """Reply to the end of a measurement, behind what a stream still holds."""
        said = b""
        if self._stream is not None:
            self._stream.stop()
            said, self._stream = self._stream.packet(), None
        if self._measurement is not None and not self._measurement.done:
            self._measurement.done = True
        return said + packets.reply(STOP, OK)

    def _start_nivel(self) -> bytes:
        if not self._has_nivel:
            return packets.reply(START_NIVEL, NO_NIVEL)
        instrument = self._server.instrument
        time_s = self._server.now_s
        # A level instrument on a floor that gives a little; in mrad, whatever the units.
        tilts = (0.01 * math.sin(time_s / 300.0), 0.01 * math.cos(time_s / 300.0))
        self._later(self._server.begin(_NIVEL_S, lambda: packets.nivel(*tilts, instrument.air()[0])))
        return packets.reply(START_NIVEL, OK)

    def _go_and_measure(self, command: Command) -> bytes:
        """Point at a place like command 55, and measure; the reply stands before the result."""
        if len(command.parameters) != struct.calcsize("<3d"):
            return packets.reply(command.number, parameters.WRONG_PARAMETER)
        if refusal := self._server.refusal_to_measure(command.number):
            return refusal
        go = self._server.carry_out(Command(55, command.parameters + struct.pack("<i", 1)))
        if isinstance(go, bytes):
            return packets.reply(command.number, struct.unpack_from("<i", go, 12)[0])
        duration_s = 1e-3 * self._server.kept[parameters.STATIONARY][0]
        self._later(
            self._server.begin(go.due_s - self._server.now_s + duration_s, lambda: self._result(duration_s))
        )
        return packets.reply(command.number, OK)

    def _streamed(self, stream: Stream) -> bytes:
        said = b""
        if self._server.now_s >= stream.due_s:
            said = stream.packet()
        if stream.ended:
            self._stream = None
            if stream.broken:
                return said + packets.error(START, NO_RESULT)
            self._server.news.add(_COUNT_REACHED)
        return said

    def _news(self) -> bytes:
        server, said = self._server, b""
        settings = server.kept[parameters.SETTINGS]
        if settings[parameters.UNSOLICITED]:
            state = _BUSY if server.busy else _READY if server.instrument.locked else _NOT_READY
            codes = [*server.news.since(self._told), *([state] if state != self._state else [])]
            self._state = state
            said = b"".join(map(packets.state_changed, codes))
        self._told = server.news.count
        if settings[parameters.REFLECTOR_POSITIONS] and server.instrument.locked:
            said += packets.reflector_position(server.instrument.units.place(server.instrument.glance_mm))
        return said
