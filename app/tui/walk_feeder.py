"""Keeping a walk going from this terminal: as long as a key repeats, the engine is fed. It is no enabling device."""

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any, Final

from catseye.app.service.dead_man import DeadMan
from catseye.app.tui.link import Link
from catseye.app.tui.requests import Requests

FEED_S: Final = 0.05
"""Between two feedings; the engine waits 0.3 s for them."""


class WalkFeeder:
    """Feeds the engine while a key is held.

    Args:
        now_s: monotonic time, s.
        failed: called with why the engine is not fed.
        sleep: waits, real s.
    """

    def __init__(
        self,
        link: Link,
        now_s: Callable[[], float],
        failed: Callable[[str], None],
        sleep: Callable[[float], Coroutine[Any, Any, None]] = asyncio.sleep,
    ) -> None:
        self._requests = Requests(link, failed)
        self._now_s = now_s
        self._failed = failed
        self._sleep = sleep
        self._key: DeadMan[str] = DeadMan()
        self._feeding: asyncio.Task[None] | None = None

    @property
    def held(self) -> bool:
        """The key is held, as far as presses show."""
        return self._feeding is not None and not self._feeding.done()

    def press(self) -> None:
        """Take a press or a repeat of the key; nothing moves before it has repeated once."""
        now_s = self._now_s()
        self._key.press("walk", now_s)
        if not self.held and self._key.held(now_s) is not None:
            self._requests.refused = False
            self._feeding = asyncio.create_task(self._feed())

    def let_go(self) -> None:
        """Have the arm stopped now."""
        self._key.let_go()
        if self._feeding is not None and self.held:
            self._feeding.cancel()

    async def _feed(self) -> None:
        from catseye.app.protocol.requests import WalkFeed

        try:
            while self._key.held(self._now_s()) is not None:
                if self._requests.unanswered:
                    self._failed(
                        "the engine does not answer any more: it stops the arm by itself; look at it"
                    )
                    break
                # What was refused once is asked for again when the key was let go.
                if not self._requests.refused:
                    self._requests.send(WalkFeed())
                await self._sleep(FEED_S)
        finally:
            # However this ends, the key has to be pressed again.
            self._key.let_go()
            # A walk that has just ended needs no feeding any more.
            self._requests.send(WalkFeed(on=False), needed=False)
