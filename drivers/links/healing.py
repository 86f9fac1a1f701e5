"""Lost, doubled and garbled answers: what is harmless is asked again, a link that loses too much is given up."""

import asyncio
from collections import Counter, deque
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from enum import Enum
from typing import Final, TypeVar

from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.errors import LinkError, LinkTimeoutError, ProtocolError, UnreachableError

T = TypeVar("T")

HEALS: Final[Counter[str]] = Counter()
"""How often each link of this process was healed, by device and endpoint; for whoever watches the process."""


WINDOW_S = 10.0
"""Over which losses are counted, real s."""

MOST_LOST = 0.2
"""Share of lost answers within the window above which a link is given up."""

ATTEMPTS = 6
"""How often something harmless is asked at most, within ten seconds."""

REOPEN_S = 2.0
"""For so long a device that has just dropped its connections may refuse new ones, real s."""

_REOPEN_PAUSE_S = 0.1

_FEWEST_LOST = 8
"""Fewer losses within the window say nothing about their share."""


class Repeat(Enum):
    """What may be done with a request whose answer is lost."""

    HARMLESS = "heal the link and ask again"
    NEVER = "report the loss; the link is healed before the request if need be"
    BOUND = "report the loss, and refuse on a link out of step: it builds on what was said on this very connection"


@dataclass
class _Second:
    """Exchanges that began within one second."""

    number: int
    answered: int = 0
    lost: int = 0


class Losses:
    """Counts answers and losses of one link over the last ten seconds.

    Args:
        now_s: real time, s; that of the event loop by default.
    """

    def __init__(self, now_s: Callable[[], float] | None = None) -> None:
        self.now_s = now_s or (lambda: asyncio.get_running_loop().time())
        self._seconds: deque[_Second] = deque()

    def answered(self) -> None:
        """Count an answer that came whole."""
        self._second().answered += 1

    def lost(self) -> None:
        """Count an answer that did not come or was garbage."""
        self._second().lost += 1

    @property
    def counted(self) -> tuple[int, int]:
        """Lost answers and all answers within the window."""
        self._second()
        lost = sum(second.lost for second in self._seconds)
        return lost, lost + sum(second.answered for second in self._seconds)

    @property
    def too_many(self) -> bool:
        """Whether the link is to be given up."""
        lost, count = self.counted
        return lost >= _FEWEST_LOST and lost > MOST_LOST * count

    def forget(self) -> None:
        """Begin anew."""
        self._seconds.clear()

    def _second(self) -> _Second:
        number = int(self.now_s())
        if self._seconds and self._seconds[-1].number == number:
            return self._seconds[-1]
        while self._seconds and self._seconds[0].number <= number - WINDOW_S:
            self._seconds.popleft()
        self._seconds.append(_Second(number))
        return self._seconds[-1]


def note_heal(transport: Transport, where: str, why: str) -> None:
    """Count the healing of a link, and note it in its transcript.

    Args:
        where: device and endpoint.
        why: what put it out of step, with the bytes that came.
    """
    HEALS[where] += 1
    transport.note_heal(why)


async def repeated(work: Callable[[], Awaitable[T]], losses: Losses, where: str) -> T:
    """Do harmless work; when an answer is lost, do it again from its beginning.

    Args:
        work: heals its link first if need be.
        where: device and endpoint, for the text.

    Raises:
        LinkError: the link loses too much, or whatever the last attempt raised.
        ProtocolError: the last attempt brought garbage.
    """
    until_s = losses.now_s() + WINDOW_S
    for _ in range(ATTEMPTS - 1):
        try:
            return await work()
        except UnreachableError:
            raise
        except (LinkError, ProtocolError) as exc:
            if losses.now_s() >= until_s:
                # A device that is silent rather than disturbed.
                raise
            if losses.too_many:
                lost, count = losses.counted
                kind = LinkTimeoutError if isinstance(exc, LinkTimeoutError) else LinkError
                raise kind(
                    f"{where}: {lost} of {count} answers within {WINDOW_S:g} s were lost: the link is given up; "
                    f"check cable, connectors and shielding, and that no other program uses it (last: {exc})"
                ) from exc
    return await work()


async def reopened(attempt: Callable[[], Awaitable[None]], hopeful: Callable[[], bool]) -> None:
    """Open a link again that was lost; try for a while, since its device may refuse for a moment.

    Args:
        hopeful: whether another attempt makes sense.

    Raises:
        LinkError: as the last attempt raised it.
    """
    loop = asyncio.get_running_loop()
    until_s = loop.time() + REOPEN_S
    while True:
        try:
            return await attempt()
        except LinkError:
            if loop.time() + _REOPEN_PAUSE_S > until_s or not hopeful():
                raise
        await asyncio.sleep(_REOPEN_PAUSE_S)
