"""Instruments that send by themselves: a task takes in what comes, callers wait for news."""

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from typing import Generic, Protocol, TypeVar

from catseye.drivers.links.healing import Losses, note_heal, reopened, repeated
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import DeviceError, LinkError, LinkTimeoutError

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)

MOST_BYTES_A_SECOND = 4_000_000
"""Of a stream; more is a flood, real time."""

MOST_BYTES_WITHOUT_FRAME = 65_536
"""So much in which no frame is found is a flood, however slowly it is taken in."""

_SHOWN_BYTES = 80


class FrameDecoder(Protocol[T_co]):
    """Cuts frames out of a stream that may begin in the middle of one."""

    def feed(self, data: bytes) -> Sequence[T_co]:
        """Take a chunk; return the frames that are complete now."""
        ...


class Flow:
    """Adds up what comes within a second of the event loop's time, and what came since the last frame."""

    def __init__(self) -> None:
        self._began_s = asyncio.get_running_loop().time()
        self._count = 0
        self._frameless = 0

    def framed(self) -> None:
        """Take note of a frame."""
        self._frameless = 0

    def flood(self, count: int) -> str:
        """Add bytes; return why they are more than any instrument sends, empty when they are not."""
        now_s = asyncio.get_running_loop().time()
        if now_s - self._began_s >= 1.0:
            self._began_s, self._count = now_s, 0
        self._count += count
        self._frameless += count
        if self._count > MOST_BYTES_A_SECOND:
            return f"more than {MOST_BYTES_A_SECOND} bytes come within a second"
        if self._frameless > MOST_BYTES_WITHOUT_FRAME:
            return f"more than {MOST_BYTES_WITHOUT_FRAME} bytes come without a value"
        return ""


class StreamLink(Generic[T]):
    """A link on which frames come unasked.

    A stream that stops or a link that breaks is an error of whoever waits; the next `ensure` opens it again.

    Args:
        decoder: makes the decoder of a new link.
        take: is given each frame and its time of arrival, s.
        greet: runs after each opening; asks who is there or waits for the first frames.
    """

    def __init__(
        self,
        transport: Transport,
        clock: Clock,
        *,
        name: str,
        decoder: Callable[[], FrameDecoder[T]],
        take: Callable[[T, float], None],
        greet: Callable[[], Awaitable[None]],
    ) -> None:
        self._transport = transport
        self._clock = clock
        self._name = name
        self._decoder = decoder
        self._take = take
        self._greet = greet
        self._news = asyncio.Event()
        self._lock = asyncio.Lock()
        self._reader: asyncio.Task[None] | None = None
        self._failure: DeviceError | None = None
        self._is_open = False
        self._last_bytes = b""
        self._losses = Losses()
        self.heal_count = 0

    @property
    def where(self) -> str:
        """Device and endpoint, for texts."""
        return f"{self._name} at {self._transport.endpoint}"

    @property
    def last_bytes(self) -> bytes:
        """The last bytes that came, bounded."""
        return self._last_bytes

    async def open(self) -> None:
        """Connect and greet.

        Raises:
            DeviceError: unreachable, or whatever the greeting finds; the link is closed then.
        """
        async with self._lock:
            self._is_open = True
            try:
                await self._connect()
            except (DeviceError, asyncio.CancelledError):
                await self.close()
                raise

    async def close(self) -> None:
        """Disconnect at once; may be called any number of times."""
        self._is_open = False
        await self._hang_up()

    async def ensure(self) -> None:
        """Open the link again if it broke.

        Raises:
            DeviceError: it is not open, or cannot be opened now.
        """
        async with self._lock:
            if not self._is_open:
                raise LinkError(f"{self.where}: not connected: connect first")
            # A link that was closed meanwhile shows when the reader has had its turn.
            await asyncio.sleep(0)
            await asyncio.sleep(0)
            if self._failure is not None:
                self.heal_count += 1
                why = f"{self._failure}; last bytes {self._last_bytes!r}"
                note_heal(self._transport, self.where, why)
                await reopened(self._connect, lambda: self._is_open)

    async def send(self, data: bytes) -> None:
        """Send bytes.

        Raises:
            LinkError: the link is closed.
        """
        await self._transport.write(data)

    async def wait(self, arrived: Callable[[], bool], timeout_s: float, what: str) -> None:
        """Wait until something has come.

        Args:
            timeout_s: how long at most, real s.

        Raises:
            LinkTimeoutError: it does not come; the link is opened again by the next `ensure`.
            LinkError: the link broke.
        """
        if not await self._came(arrived, timeout_s):
            self._failure = self._silence(what, timeout_s)
            raise self._failure

    async def order(self, data: bytes, arrived: Callable[[], bool], timeout_s: float, what: str) -> None:
        """Send something harmless and wait until it is acknowledged; send it again when it is not.

        Args:
            arrived: whether it is acknowledged.
            timeout_s: how long to wait for each acknowledgement, real s.

        Raises:
            LinkTimeoutError: it is never acknowledged; the link is opened again by the next `ensure`.
            LinkError: the link broke, or loses too much.
        """

        async def once() -> None:
            await self.send(data)
            if not await self._came(arrived, timeout_s):
                self._losses.lost()
                raise self._silence(what, timeout_s)
            self._losses.answered()

        try:
            await repeated(once, self._losses, self.where)
        except LinkError as exc:
            self._failure = exc
            raise

    async def _came(self, arrived: Callable[[], bool], timeout_s: float) -> bool:
        try:
            async with asyncio.timeout(timeout_s):
                while not arrived():
                    if self._failure is not None:
                        raise self._failure
                    self._news.clear()
                    await self._news.wait()
        except TimeoutError:
            return False
        return True

    def _silence(self, what: str, timeout_s: float) -> LinkTimeoutError:
        came = f"last bytes {self._last_bytes!r}" if self._last_bytes else "no byte came"
        return LinkTimeoutError(
            f"{self.where}: no {what} within {timeout_s:g} s, {came}: check that the instrument is switched on "
            "and sends, and the line's settings; the link is opened again before the next request"
        )

    async def _connect(self) -> None:
        await self._hang_up()
        self._failure = LinkError(f"{self.where}: the greeting is not finished")
        await self._transport.open()
        if not self._is_open:
            # `close` came while the transport was being opened and found nothing to close.
            await self._transport.close()
            raise LinkError(f"{self.where}: the link was closed while it was being opened: connect again")
        self._last_bytes = b""
        self._failure = None
        self._reader = asyncio.create_task(self._take_in(self._decoder()))
        try:
            await self._greet()
        except BaseException as exc:
            # Whatever ended the greeting, nobody may build on a link that was half greeted.
            self._failure = (
                exc if isinstance(exc, DeviceError) else LinkError(f"{self.where}: greeting ended")
            )
            raise

    async def _hang_up(self) -> None:
        reader, self._reader = self._reader, None
        if reader is not None:
            reader.cancel()
            await asyncio.wait({reader})
        await self._transport.close()
        self._failure = self._failure or LinkError(f"{self.where}: the link was closed")
        self._news.set()

    async def _take_in(self, decoder: FrameDecoder[T]) -> None:
        flow = Flow()
        try:
            while True:
                data = await self._transport.read()
                time_s = self._clock.monotonic_s()
                if why := flow.flood(len(data)):
                    await self._transport.close()
                    raise LinkError(
                        f"{self.where}: {why}, such as "
                        f"{data[:_SHOWN_BYTES]!r}: the link was closed; check that this is the instrument meant"
                    )
                self._last_bytes = (self._last_bytes + data)[-_SHOWN_BYTES:]
                for frame in decoder.feed(data):
                    flow.framed()
                    self._take(frame, time_s)
                self._news.set()
        except DeviceError as exc:
            self._failure = exc
            self._news.set()
