"""A pipe in memory: two transports that lead to one another, without socket, time or thread."""

import asyncio
from typing import Self

from catseye.drivers.roles.errors import LinkError


class MemoryTransport:
    """One end of a pipe; what one end writes, the other reads in the same chunks."""

    def __init__(self, endpoint: str) -> None:
        self._endpoint = endpoint
        self._peer: Self | None = None
        self._inbox: asyncio.Queue[bytes | None] = asyncio.Queue()
        self._is_open = False

    def join(self, peer: Self) -> None:
        """Make both ends lead to one another."""
        self._peer, peer._peer = peer, self

    @property
    def endpoint(self) -> str:
        """The name given."""
        return self._endpoint

    @property
    def is_open(self) -> bool:
        """Until `close`; the other end may be gone."""
        return self._is_open

    async def open(self) -> None:
        """Open this end; what was sent before is gone, as with a new connection."""
        if not self._is_open:
            self._inbox = asyncio.Queue()
            self._is_open = True

    async def close(self) -> None:
        """Close this end; the other end reads what it was sent, then the end of the link."""
        if self._is_open:
            self._is_open = False
            self._inbox.put_nowait(None)
            if self._peer:
                self._peer._inbox.put_nowait(None)  # noqa: SLF001  # the other end of the same pipe

    async def write(self, data: bytes) -> None:
        """Send all bytes as one chunk.

        Raises:
            LinkError: one of the ends is closed.
        """
        self.send_urgent(data)

    def send_urgent(self, data: bytes, *, cut: bytes = b"") -> None:
        """Send all bytes as one chunk; nothing ever waits here, so nothing is cut.

        Raises:
            LinkError: one of the ends is closed.
        """
        del cut
        if not self._is_open or not self._peer or not self._peer.is_open:
            raise LinkError(f"{self._endpoint}: the link is closed: open both ends first")
        if data:
            self._peer._inbox.put_nowait(data)  # noqa: SLF001  # the other end of the same pipe

    def note_heal(self, why: str) -> None:
        """Note nothing: no transcript is kept here."""
        del why

    def fileno(self) -> int:
        """Refuse: there is none.

        Raises:
            LinkError: always.
        """
        raise LinkError(f"{self._endpoint}: a pipe in memory has no descriptor")

    async def read(self) -> bytes:
        """Return the next chunk.

        Raises:
            LinkError: this end is closed or the other end has been closed.
        """
        self._require_open()
        return self._checked(await self._inbox.get())

    def waiting(self) -> bytes:
        """Return a chunk that has come, empty bytes when nothing has.

        Raises:
            LinkError: this end is closed or the other end has been closed.
        """
        self._require_open()
        return b"" if self._inbox.empty() else self._checked(self._inbox.get_nowait())

    def _require_open(self) -> None:
        if not self._is_open:
            raise LinkError(f"{self._endpoint}: the link is closed: open it first")

    def _checked(self, chunk: bytes | None) -> bytes:
        if chunk is None:
            raise LinkError(f"{self._endpoint}: the other side has closed the link: open it again")
        return chunk


def pipe(endpoint: str = "memory://pipe") -> tuple[MemoryTransport, MemoryTransport]:
    """Return the two ends of a new pipe, both closed."""
    near, far = MemoryTransport(endpoint), MemoryTransport(f"{endpoint}#far")
    near.join(far)
    return near, far
