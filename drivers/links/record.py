"""A transport that shows every byte that passes."""

from catseye.drivers.links.transport import Transport, WrappedTransport
from catseye.drivers.roles.device import Sink


class RecordingTransport(WrappedTransport):
    """Hands what passes through a transport to a sink.

    Args:
        sink: is called with direction and bytes: sent ones before they are sent, since a transcript
            must hold what a failed write may have put on the wire. Healings stand between them.
    """

    def __init__(self, inner: Transport, sink: Sink) -> None:
        super().__init__(inner)
        self._sink = sink

    async def write(self, data: bytes) -> None:
        """Send all bytes.

        Raises:
            LinkError: the link is closed.
        """
        self._sink("tx", data)
        await self._inner.write(data)

    def send_urgent(self, data: bytes, *, cut: bytes = b"") -> None:
        """Send bytes past what waits.

        Raises:
            LinkError: the link is closed or takes no bytes.
        """
        self._sink("tx", data)
        self._inner.send_urgent(data, cut=cut)

    def note_heal(self, why: str) -> None:
        """Note why the link is healed."""
        self._sink("heal", why.encode())

    async def read(self) -> bytes:
        """Return the next chunk, at least one byte.

        Raises:
            LinkError: the other side has closed the link.
        """
        data = await self._inner.read()
        self._sink("rx", data)
        return data

    def waiting(self) -> bytes:
        """Return a chunk that has come, empty bytes when nothing has.

        Raises:
            LinkError: the other side has closed the link.
        """
        data = self._inner.waiting()
        if data:
            self._sink("rx", data)
        return data
