"""What waits to be sent to one client: bounded, and what it loses is counted."""

import asyncio
from collections import deque
from dataclasses import dataclass

from catseye.app.service.merging import MERGED, merged
from catseye.app.service.messages import VERSION, Message
from catseye.procedures.kit.context import Json

_DROPPABLE = frozenset({"point", "step-started", "step-done"})

_NEWEST = frozenset({"progress", "clients"})

_KEPT = frozenset({"clients"})
"""Of these the newest is never dropped: nobody tells it again."""

CAPACITY = 512
"""Messages that wait for a slow client."""


class MailboxFullError(Exception):
    """A message that may not be dropped finds no room."""


@dataclass
class _Waiting:
    message: Message
    kind: str | None
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

    def put(self, message: Message) -> None:
        """Add a message.

        Raises:
            MailboxFullError: it may not be dropped, and the mailbox is full of such.
        """
        kind = _replaced_kind(message)
        droppable = (kind is not None and kind not in _KEPT) or message.get("event") in _DROPPABLE
        if kind is not None:
            for waiting in self._waiting:
                if waiting.kind == kind:
                    waiting.message = merged(waiting.message, message)
                    return
        if len(self._waiting) >= self._capacity and not self._make_room(droppable):
            return
        self._waiting.append(_Waiting(message, kind, droppable))
        self._filled.set()

    def close(self) -> None:
        """No message follows."""
        self._closed = True
        self._filled.set()

    async def take(self) -> Message:
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
            return {"v": VERSION, "event": "dropped", "count": count}
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


def _replaced_kind(message: Message) -> str | None:
    """Return the name under which only the newest message counts."""
    event = message.get("event")
    if event in _NEWEST or event in MERGED:
        return str(event)
    if event == "state" and message.get("kind") == "live":
        data: Json = message.get("data")
        return f"live {data['name'] if isinstance(data, dict) and 'name' in data else ''}"
    return None
