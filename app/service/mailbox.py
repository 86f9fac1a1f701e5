"""What waits to be sent to one client: bounded, and what it loses is counted."""

import asyncio
from collections import deque
from dataclasses import dataclass

from catseye.app.protocol.engine_events import (
    BenchSeen,
    ClientsChanged,
    Dropped,
    SamplesTaken,
    WirePassed,
)
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.run_events import (
    LiveShown,
    PointMeasured,
    Progressed,
    StepDone,
    StepStarted,
)
from catseye.app.service.watching.columns import MOST_COLUMNS
from catseye.app.service.watching.traffic import MOST_LINES

CAPACITY = 512
"""Messages that wait for a slow client."""


class MailboxFullError(Exception):
    """A message that may not be dropped finds no room."""


@dataclass
class _Waiting:
    message: AnyEvent | bytes
    slot: str | None
    droppable: bool


class Mailbox:
    """A bounded queue. The newest live value, progress and bench replace older ones; points and steps may be dropped.

    Args:
        capacity: how many messages wait at most.
    """

    def __init__(self, capacity: int = CAPACITY) -> None:
        self._capacity = capacity
        self._waiting: deque[_Waiting] = deque()
        self._dropped = 0
        self._filled = asyncio.Event()
        self._closed = False

    def __len__(self) -> int:
        return len(self._waiting)

    def put(self, message: AnyEvent | bytes) -> None:
        """Add an event, or an encoded answer.

        Raises:
            MailboxFullError: it may not be dropped, and the mailbox is full of such.
        """
        slot, droppable = None, False
        if not isinstance(message, bytes):
            slot, droppable = _slot(message), _droppable(message)
            for waiting in self._waiting if slot is not None else ():
                if waiting.slot == slot and not isinstance(waiting.message, bytes):
                    waiting.message = _merged(waiting.message, message)
                    return
        if len(self._waiting) >= self._capacity and not self._make_room(droppable):
            return
        self._waiting.append(_Waiting(message, slot, droppable))
        self._filled.set()

    def close(self) -> None:
        """No message follows."""
        self._closed = True
        self._filled.set()

    async def take(self) -> AnyEvent | bytes:
        """Wait for the next message; a count of dropped ones comes before it.

        Raises:
            EOFError: the mailbox is closed, and empty.
        """
        while not self._waiting and not self._dropped:
            if self._closed:
                raise EOFError("no message follows")
            self._filled.clear()
            await self._filled.wait()
        if self._dropped:
            count, self._dropped = self._dropped, 0
            return Dropped(count=count)
        return self._waiting.popleft().message

    def _make_room(self, droppable: bool) -> bool:
        """Drop one message, the new one if it may be; return whether there is room for the new one."""
        if droppable:
            self._dropped += 1
            self._filled.set()
            return False
        for number, waiting in enumerate(self._waiting):
            if waiting.droppable:
                del self._waiting[number]
                self._dropped += 1
                return True
        raise MailboxFullError(f"{len(self._waiting)} messages wait that may not be dropped")


def _slot(event: AnyEvent) -> str | None:
    """Return the name under which only the newest event counts; None where each one does."""
    match event:
        case LiveShown():
            return f"live {event.data.name}"
        case Progressed() | ClientsChanged() | BenchSeen() | SamplesTaken() | WirePassed():
            return event.event
    return None


def _droppable(event: AnyEvent) -> bool:
    """Return whether a client can do without an event; the list of clients comes once only."""
    if isinstance(event, ClientsChanged):
        return False
    return _slot(event) is not None or isinstance(event, PointMeasured | StepStarted | StepDone)


def _merged(older: AnyEvent, newer: AnyEvent) -> AnyEvent:
    """Return the event that is sent in place of two of the same kind; what is left out is counted."""
    match older, newer:
        case BenchSeen(), BenchSeen():
            return newer.model_copy(update={"missed": older.missed + 1 + newer.missed})
        case SamplesTaken(), SamplesTaken():
            surplus = max(0, len(older.count) + len(newer.count) - MOST_COLUMNS)
            columns = {
                "low": (older.low + newer.low)[surplus:],
                "high": (older.high + newer.high)[surplus:],
                "count": (older.count + newer.count)[surplus:],
            }
            return newer.model_copy(update={**columns, "missed": older.missed + newer.missed + surplus})
        case WirePassed(), WirePassed():
            lines = older.lines + newer.lines
            surplus = max(0, len(lines) - MOST_LINES)
            missed = older.missed + newer.missed + surplus
            return newer.model_copy(update={"lines": lines[surplus:], "missed": missed})
    return newer
