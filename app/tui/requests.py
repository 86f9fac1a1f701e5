"""Requests to the engine that are repeated while a key is held, and that nobody waits for one by one."""

import asyncio
from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.tui.link import Link

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.requests import AnyRequest

_UNANSWERED: Final = 60
"""Requests without an answer; the engine answers the first hold when the joint has been set going."""


class Requests:
    """Sends requests in order, and reports the first refusal.

    Args:
        failed: called with why a request was refused.

    Attributes:
        refused: whether one was refused since this was last set to False.
    """

    def __init__(self, link: Link, failed: Callable[[str], None]) -> None:
        self.refused = False
        self._link = link
        self._failed = failed
        self._sent: set[asyncio.Task[None]] = set()

    @property
    def unanswered(self) -> bool:
        """The engine answers no more."""
        return len(self._sent) >= _UNANSWERED

    def send(self, request: "AnyRequest", *, needed: bool = True) -> None:
        """Put a request without waiting for its answer.

        Args:
            needed: a refusal is reported.
        """
        task = asyncio.create_task(self._request(request, needed=needed))
        self._sent.add(task)
        task.add_done_callback(self._sent.discard)

    async def _request(self, request: "AnyRequest", *, needed: bool) -> None:
        try:
            await self._link.request(request)
        except (RefusedError, ServiceError) as error:
            if needed and not self.refused:
                self.refused = True
                self._failed(str(error))
