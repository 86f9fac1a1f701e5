"""Bytes through a descriptor that never blocks, on the event loop: what TCP and serial lines have in common."""

import asyncio
import os
from abc import ABC, abstractmethod
from collections.abc import Callable

from catseye.drivers.links.inbox import TURN_BYTES, Inbox
from catseye.drivers.roles.errors import LinkError

_MOST_BYTES = 1 << 20
_SHOWN_BYTES = 80


class Channel:
    """Reads as bytes come and writes as the operating system takes them.

    A peer that ends or floods what it says can still be written to: a STOP may yet be heard.

    Args:
        descriptor: non-blocking; whoever opened it closes it.
        ended: why nothing more comes when the other side ends it.
        broken: why the link broke, from the error of the operating system.
    """

    def __init__(
        self, descriptor: int, endpoint: str, *, ended: str, broken: Callable[[OSError], str]
    ) -> None:
        self._descriptor = descriptor
        self._endpoint = endpoint
        self._ended = ended
        self._broken = broken
        self._loop = asyncio.get_running_loop()
        self._inbox = Inbox(_MOST_BYTES)
        self._unsent = bytearray()
        self._sent: asyncio.Future[None] | None = None
        self._waits_for_room = False
        self._overtaken = 0
        self._over: LinkError | None = None
        self._loop.add_reader(descriptor, self._receive)

    @property
    def is_open(self) -> bool:
        """Whether it can be written to."""
        return self._over is None

    def fileno(self) -> int:
        """Return the descriptor.

        Raises:
            LinkError: closed or broken.
        """
        self._require_open()
        return self._descriptor

    def close(self, error: LinkError) -> None:
        """Let go of the descriptor; whoever reads or writes learns why. May be called any number of times."""
        if self._over is not None:
            return
        self._over = error
        self._inbox.end(error)
        self._loop.remove_reader(self._descriptor)
        self._loop.remove_writer(self._descriptor)
        self._unsent.clear()
        self._end_writing()

    async def write(self, data: bytes) -> None:
        """Send all bytes.

        Raises:
            LinkError: closed or broken, or something urgent took the place of these bytes.
        """
        self._require_open()
        overtaken = self._overtaken
        self._unsent += data
        if len(self._unsent) == len(data):
            self._flush()
        if self._unsent:
            if self._sent is None or self._sent.done():
                self._sent = self._loop.create_future()
            # Another writer may wait for the same bytes: a cancellation must not take the future from it.
            await asyncio.shield(self._sent)
        self._require_open()
        if overtaken != self._overtaken:
            raise LinkError(
                f"{self._endpoint}: {data[:_SHOWN_BYTES]!r} was dropped for something urgent: ask again"
            )

    def send_urgent(self, data: bytes, cut: bytes) -> None:
        """Hand bytes to the operating system at once; what it had not taken before is dropped.

        Args:
            cut: goes in front when something is dropped, so that the other side takes what it has of it as ended.

        Raises:
            LinkError: closed or broken, or not all bytes are taken at once; the rest goes as soon as it is.
        """
        self._require_open()
        if self._unsent:
            self._overtaken += 1
            self._unsent[:] = cut + data
            self._end_writing()
        else:
            self._unsent += data
        self._flush()
        self._require_open()
        if self._unsent:
            raise LinkError(f"{self._endpoint}: the line takes no bytes now: check cable and the other side")

    async def read(self) -> bytes:
        """Return the next chunk.

        Raises:
            LinkError: closed or broken, or the other side has ended it.
        """
        return await self._inbox.read()

    def waiting(self) -> bytes:
        """Return a chunk that has come, empty bytes when nothing has or this turn of the loop has had its share.

        Raises:
            LinkError: closed or broken, or the other side has ended it.
        """
        chunk = self._inbox.take()
        if not chunk and not self._inbox.spent:
            self._require_open()
            self._receive()
            chunk = self._inbox.take()
        return chunk

    def _receive(self) -> None:
        """Take in what has come."""
        if self._over is not None or self._inbox.ended is not None:
            return
        try:
            data = os.read(self._descriptor, TURN_BYTES)
        except (BlockingIOError, InterruptedError):
            return
        except OSError as exc:
            self._break(exc)
            return
        if not data:
            self._hear_no_more(self._ended)
        elif not self._inbox.put(data):
            self._hear_no_more("bytes keep coming that nobody reads: check that this is the right instrument")

    def _hear_no_more(self, why: str) -> None:
        self._inbox.end(LinkError(f"{self._endpoint}: {why}"))
        self._loop.remove_reader(self._descriptor)

    def _flush(self) -> None:
        """Send what is taken; come again for the rest when there is room."""
        try:
            count = os.write(self._descriptor, self._unsent)
        except (BlockingIOError, InterruptedError):
            count = 0
        except OSError as exc:
            self._break(exc)
            return
        del self._unsent[:count]
        if self._unsent:
            self._loop.add_writer(self._descriptor, self._flush)
            self._waits_for_room = True
        elif self._waits_for_room:
            self._loop.remove_writer(self._descriptor)
            self._waits_for_room = False
            self._end_writing()

    def _end_writing(self) -> None:
        if self._sent is not None and not self._sent.done():
            self._sent.set_result(None)

    def _break(self, exc: OSError) -> None:
        self.close(LinkError(f"{self._endpoint}: {self._broken(exc)}"))

    def _require_open(self) -> None:
        if self._over is not None:
            raise LinkError(str(self._over))


class ChannelTransport(ABC):
    """Base of the transports through a descriptor; those that derive from it open and close it."""

    def __init__(self) -> None:
        self._channel: Channel | None = None

    @property
    @abstractmethod
    def endpoint(self) -> str:
        """Where it leads."""

    async def write(self, data: bytes) -> None:
        """Send all bytes.

        Raises:
            LinkError: the link is closed or broken.
        """
        await self._require_opened().write(data)

    def send_urgent(self, data: bytes, *, cut: bytes = b"") -> None:
        """Hand bytes to the operating system past what waits; see `Transport.send_urgent`.

        Raises:
            LinkError: the link is closed or broken, or takes no bytes now.
        """
        self._require_opened().send_urgent(data, cut)

    def note_heal(self, why: str) -> None:
        """Note nothing: no transcript is kept here."""
        del why

    def fileno(self) -> int:
        """Return the descriptor.

        Raises:
            LinkError: the link is closed or broken.
        """
        return self._require_opened().fileno()

    async def read(self) -> bytes:
        """Return the next chunk.

        Raises:
            LinkError: the link is closed or broken, or the other side has closed it.
        """
        return await self._require_opened().read()

    def waiting(self) -> bytes:
        """Return a chunk that has come, empty bytes when nothing has.

        Raises:
            LinkError: the link is closed or broken, or the other side has closed it.
        """
        return self._require_opened().waiting()

    def _is_open(self) -> bool:
        return self._channel is not None and self._channel.is_open

    def _let_go(self) -> None:
        """Take the channel from the descriptor before that is closed."""
        if self._channel:
            self._channel.close(LinkError(f"{self.endpoint}: the link was closed: connect again"))

    def _require_opened(self) -> Channel:
        if not self._channel:
            raise LinkError(f"{self.endpoint}: the link is not open: connect first")
        return self._channel
