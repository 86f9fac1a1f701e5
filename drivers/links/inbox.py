"""What has come over a link and was not read yet."""

import asyncio
from collections import deque

from catseye.drivers.roles.errors import LinkError

TURN_BYTES = 4096
"""So much of one link is handed out within one turn of the event loop."""

TURN_S = 0.005
"""So long one link may hold a turn of the event loop by handing out what has come, real s."""


class Inbox:
    """Chunks in the order in which they came, then perhaps the end of the link. One reader at a time.

    Only so much is handed out within one turn of the event loop: a device that floods its link delays no other one.

    Args:
        most_bytes: how much is kept.
    """

    def __init__(self, most_bytes: int) -> None:
        self._most_bytes = most_bytes
        self._chunks: deque[bytes] = deque()
        self._held_bytes = 0
        self._end: LinkError | None = None
        self._reader: asyncio.Future[None] | None = None
        self._turn_bytes = 0
        self._turn_began_s = 0.0

    def put(self, chunk: bytes) -> bool:
        """Keep a chunk; return False, and keep nothing, when it does not fit or the link has ended."""
        if self._end is not None or self._held_bytes + len(chunk) > self._most_bytes:
            return False
        self._chunks.append(chunk)
        self._held_bytes += len(chunk)
        self._wake()
        return True

    def end(self, error: LinkError) -> None:
        """Note that the link has ended, unless it had before; readers see it behind what has come."""
        self._end = self._end or error
        self._wake()

    @property
    def ended(self) -> LinkError | None:
        """Why nothing more will come; None as long as the link holds."""
        return self._end

    @property
    def spent(self) -> bool:
        """Whether this turn of the loop has had its share."""
        if not self._turn_bytes:
            return False
        late = asyncio.get_running_loop().time() - self._turn_began_s > TURN_S
        return late or self._turn_bytes >= TURN_BYTES

    def take(self) -> bytes:
        """Return the oldest chunk, empty bytes when there is none or this turn of the loop has had its share.

        Raises:
            LinkError: the link has ended.
        """
        if self._chunks:
            return b"" if self.spent else self._handed_out()
        if self._end is not None:
            raise LinkError(str(self._end))
        return b""

    async def read(self) -> bytes:
        """Wait for the next chunk.

        Raises:
            LinkError: the link has ended.
        """
        while not (chunk := self.take()):
            if self._chunks:
                # Held back only until the next turn, which renews the share.
                await asyncio.sleep(0)
                continue
            self._reader = asyncio.get_running_loop().create_future()
            await self._reader
        return chunk

    def _handed_out(self) -> bytes:
        chunk = self._chunks.popleft()
        self._held_bytes -= len(chunk)
        if not self._turn_bytes:
            loop = asyncio.get_running_loop()
            self._turn_began_s = loop.time()
            loop.call_soon(self._next_turn)
        self._turn_bytes += len(chunk)
        return chunk

    def _next_turn(self) -> None:
        self._turn_bytes = 0

    def _wake(self) -> None:
        if self._reader is not None and not self._reader.done():
            self._reader.set_result(None)
