"""One client of the robot controller: requests in, answers with their prefixes out (sheet, sections 1.2 and 1.6).

CR, LF, CR LF, NUL or a pause ends a request; a pause ends what is no command only after some time.
"""

import re
from collections import deque
from collections.abc import Callable

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.arm_control import Run
from catseye.simulators.melfa.commands.command import Client
from catseye.simulators.melfa.commands.table import cannot_go_on, carry_out, is_complete, split
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.ports.session import Answer, Pending, Session

LONGEST_BYTES = 255
"""Largest request that a controller takes (sheet, section 1.1)."""

TOO_LONG = None
"""Stands for a request that is longer; its bytes are not kept."""

_SILENCE_S = 0.005
"""Pause after which a command that came without terminator is complete."""

_GIVEN_UP_S = 0.2
"""Pause after which the rest of what is no command is not waited for any longer."""

_END = re.compile(rb"[\r\n\0]")


class RequestBuffer:
    """Cuts requests out of what a client sends; keeps no more than it needs.

    Attributes:
        skipping: more has come than a request may have; all of it is dropped, until the request ends.
    """

    def __init__(self) -> None:
        self._bytes = bytearray()
        self._complete: list[bytes | None] = []
        self.skipping = False

    def feed(self, data: bytes) -> None:
        """Take bytes, cut anywhere."""
        self._bytes += data
        while found := _END.search(self._bytes):
            self._finish(bytes(self._bytes[: found.start()]))
            del self._bytes[: found.end()]
        if len(self._bytes) > LONGEST_BYTES:
            self._bytes.clear()
            self.skipping = True

    def take(self) -> list[bytes | None]:
        """Return the complete requests that have come, TOO_LONG for one that is too long."""
        complete, self._complete = self._complete, []
        return complete

    @property
    def rest(self) -> bytes:
        """What has come of a request that no terminator ends yet."""
        return b"" if self.skipping else bytes(self._bytes)

    @property
    def waiting(self) -> bool:
        """Something has come that a pause would complete."""
        return bool(self._bytes) or self.skipping

    def end_request(self) -> None:
        """Take what has come as complete: the client paused, or the request cannot go on."""
        self._finish(bytes(self._bytes))
        self._bytes.clear()

    def _finish(self, request: bytes) -> None:
        if self.skipping or len(request) > LONGEST_BYTES:
            self.skipping = False
            self._complete.append(TOO_LONG)
        elif request:
            self._complete.append(request)


class MelfaSession(Session):
    """Conversation with one client.

    Args:
        suffix: what is appended to each answer.
        note: called with each request.
        segments: a request may end with its segment or a pause, as on TCP; on a serial line it has a terminator.
    """

    def __init__(
        self,
        controller: Controller,
        suffix: str,
        note: Callable[[str], None],
        *,
        segments: bool = True,
    ) -> None:
        self._controller = controller
        self._segments = segments
        self._suffix = suffix
        self._note = note
        self._buffer = RequestBuffer()
        self._requests: deque[bytes | None] = deque()
        self._latest: list[bytes | None] = []
        self._client = Client()

    def feed(self, data: bytes) -> None:
        """Take bytes; a request without terminator is complete at once if nothing could follow it."""
        self._buffer.feed(data)
        rest = self._buffer.rest
        if self._segments and rest and cannot_go_on(rest.decode("latin-1")):
            self._buffer.end_request()
        self._latest = self._buffer.take()
        self._requests.extend(self._latest)

    def silence_s(self) -> float | None:
        """A pause ends a request that came without terminator; on a serial line only one that is too long."""
        if self._buffer.skipping:
            return _SILENCE_S
        if not (self._segments and self._buffer.waiting):
            return None
        return _SILENCE_S if is_complete(self._buffer.rest.decode("latin-1")) else _GIVEN_UP_S

    def idle(self) -> None:
        """Take what has come as a request."""
        self._buffer.end_request()
        self._requests.extend(self._buffer.take())

    @property
    def deaf(self) -> bool:
        """A controller that is not chosen to let STOP overtake reads nothing while EXEC2 waits."""
        return not self._controller.choices.stop_overtakes

    def overtake(self) -> None:
        """Let a STOP stop the motion that EXEC2 waits for, if so chosen; its own answer comes in its turn."""
        if not self.deaf and "STOP" in map(_word, (*self._latest, self._buffer.rest)):
            self._controller.stop()

    def answer(self) -> Answer | None:
        """Carry out the next request."""
        if not self._requests:
            return None
        request = self._requests.popleft()
        try:
            if request is TOO_LONG:
                raise Refusal(alarms.TOO_LONG)
            text = request.decode("latin-1")
            self._note(text)
            done = carry_out(self._controller, self._client, text)
        except Refusal as refusal:
            return self._refused(refusal)
        if isinstance(done, Run):
            return self._when_finished(done)
        return self._accepted(done)

    def close(self) -> None:
        """Release the operation right and the edit slot; a motion under way goes on."""
        self._controller.right_holders.discard(self._client)
        self._controller.editor.discard(self._client)

    def _when_finished(self, run: Run) -> Pending:
        bench = self._controller.bench

        def due() -> float | None:
            return run.end_s if bench.time_s < run.end_s else None

        def reply() -> bytes:
            return self._refused(Refusal(run.interrupted_by)) if run.interrupted_by else self._accepted("")

        return Pending(due, reply)

    def _accepted(self, text: str) -> bytes:
        prefix = "Qok" if self._controller.alarm_shown else "QoK"
        return f"{prefix}{text}{self._suffix}".encode("latin-1")

    def _refused(self, refusal: Refusal) -> bytes:
        # Editing commands give the place of the fault, behind another prefix (sheet, section 1.6).
        prefix = "Qer" if refusal.place else "QeR"
        said = f"{prefix}{refusal.number:04d}{refusal.detail:05d}{refusal.place}{self._suffix}"
        return said.encode("latin-1")


def _word(request: bytes | None) -> str:
    """Return the word of a request; empty of one that is none, or is too long."""
    try:
        return "" if request is TOO_LONG else split(request.decode("latin-1"))[0]
    except Refusal:
        return ""
