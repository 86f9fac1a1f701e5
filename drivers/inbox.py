"""What has come over a link and was not read yet."""

import asyncio
from collections import deque

from drivers.errors import LinkError


class Inbox:
    """Chunks in the order in which they came, then perhaps the end of the link. One reader at a time.

    Args:
        most_bytes: how much is kept.
    """

    def __init__(self, most_bytes: int) -> None:
        self._most_bytes = most_bytes
        self._chunks: deque[bytes] = deque()
        self._held_bytes = 0
        self._end: LinkError | None = None
        self._reader: asyncio.Future[None] | None = None

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

    def take(self) -> bytes:
        """Return the oldest chunk, empty bytes when there is none.

        Raises:
            LinkError: the link has ended.
        """
        if self._chunks:
            chunk = self._chunks.popleft()
            self._held_bytes -= len(chunk)
            return chunk
        if self._end is not None:
            raise LinkError(str(self._end))
        return b""

    async def read(self) -> bytes:
        """Wait for the next chunk.

        Raises:
            LinkError: the link has ended.
        """
        while not self._chunks and self._end is None:
            self._reader = asyncio.get_running_loop().create_future()
            await self._reader
        return self.take()

    def _wake(self) -> None:
        if self._reader is not None and not self._reader.done():
            self._reader.set_result(None)
