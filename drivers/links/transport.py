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

    def send_urgent(self, data: bytes, *, cut: bytes = b"") -> None:
        """Hand bytes to the operating system at once, past everything that waits to be sent; never waits itself.

        What the operating system had not taken before is dropped, and its writer gets an error.

        Args:
            cut: goes in front when something is dropped, so that the other side takes what it has of it as ended:
                the protocol's terminator.

        Raises:
            LinkError: the link is closed, or takes not all bytes now.
        """
        ...

    def fileno(self) -> int:
        """Return the descriptor of the open link, for somebody who duplicates it.

        Raises:
            LinkError: the link is closed, or has none.
        """
        ...

    def note_heal(self, why: str) -> None:
        """Note for a transcript, if one is kept, why the link that uses these bytes is healed now."""
        ...

    def waiting(self) -> bytes:
        """Return a chunk that has come and was not read, empty bytes when there is none; never waits.

        Within one turn of the event loop it returns no more than one link's share of it.

        Raises:
            LinkError: the other side has closed the link.
        """
        ...


class WrappedTransport:
    """Forwards everything to another transport: base of those that add something of their own. See `Transport`."""

    def __init__(self, inner: Transport) -> None:
        self._inner = inner

    @property
    def endpoint(self) -> str:
        """Where it leads."""
        return self._inner.endpoint

    async def open(self) -> None:
        """Connect."""
        await self._inner.open()

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        await self._inner.close()

    async def write(self, data: bytes) -> None:
        """Send all bytes."""
        await self._inner.write(data)

    async def read(self) -> bytes:
        """Return the next chunk."""
        return await self._inner.read()

    def send_urgent(self, data: bytes, *, cut: bytes = b"") -> None:
        """Hand bytes to the operating system at once."""
        self._inner.send_urgent(data, cut=cut)

    def fileno(self) -> int:
        """Return the descriptor of the open link."""
        return self._inner.fileno()

    def note_heal(self, why: str) -> None:
        """Note why the link is healed."""
        self._inner.note_heal(why)

    def waiting(self) -> bytes:
        """Return a chunk that has come, empty bytes when there is none."""
        return self._inner.waiting()


def socket_endpoint(scheme: str, host: str, port: int) -> str:
    """Return a socket as the cell file writes it; an address with colons (IPv6) stands in brackets."""
    return f"{scheme}://[{host}]:{port}" if ":" in host else f"{scheme}://{host}:{port}"
