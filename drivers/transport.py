"""The byte pipe under every driver."""

from typing import Protocol


class Transport(Protocol):
    """A two-way stream of bytes to one instrument."""

    @property
    def endpoint(self) -> str:
        """Where it leads, as in the cell file."""
        ...

    async def open(self) -> None:
        """Connect.

        Raises:
            LinkError: unreachable; the text names the endpoint and what to check.
        """
        ...

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        ...

    async def write(self, data: bytes) -> None:
        """Send all bytes.

        Raises:
            LinkError: the link is closed.
        """
        ...

    async def read(self) -> bytes:
        """Return the next chunk, at least one byte.

        Raises:
            LinkError: the other side has closed the link.
        """
        ...

    def waiting(self) -> bytes:
        """Return a chunk that has come and was not read, empty bytes when there is none; never waits.

        Raises:
            LinkError: the other side has closed the link.
        """
        ...
