"""Requests and answers over a byte stream: one at a time, and never an answer to another question."""

import asyncio
import math
from collections.abc import Awaitable, Callable
from typing import Protocol, TypeVar

from catseye.drivers.links.healing import Losses, Repeat, note_heal, reopened, repeated
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.errors import (
    DeviceError,
    LinkError,
    LinkTimeoutError,
    NotSentError,
    ProtocolError,
    UnreachableError,
)

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)

_SHOWN_BYTES = 80
_DRAIN_TIMEOUT_S = 2.0
_FIRST_TIMEOUT_S = 2.0
_FLOOD_BYTES = 65_536
"""So much without being an answer, or without having been asked for, is a flood."""

_MOST_HARMLESS_BYTES = 4096
_ATTEMPTS_IN_PLACE = 2


class Decoder(Protocol[T_co]):
    """Takes the bytes of one answer; made anew for each request."""

    @property
    def rest(self) -> bytes:
        """Bytes that came behind the answer."""
        ...

    @property
    def may_end(self) -> bool:
        """Whether what has come so far is an answer if nothing follows at once."""
        ...

    def feed(self, data: bytes) -> T_co | None:
        """Take a chunk; return the answer when it is known to be complete.

        Raises:
            ProtocolError: no answer begins like this.
        """
        ...

    def end(self) -> T_co:
        """Return the answer that ends with the silence behind it; only called when `may_end`.

        Raises:
            ProtocolError: the bytes are no answer.
        """
        ...


class RequestLink:
    """One request in flight on one transport.

    An answer that does not come leaves the link out of step: it may still come, and would then be taken for
    the answer to the next question. So after a time-out, a cancellation, garbage or bytes that nobody asked
    for, the link is healed before anything else is sent: drained until it is quiet and checked by `identify`, or,
    where that is not possible, closed, opened again, drained and checked by `greet`, which asks who is there.

    Args:
        greet: runs after each opening, with the link held; asks by `exchange` who is there.
        identify: asks by `exchange` something on the open connection whose answer cannot be mistaken for that to
            another question; None: the protocol has no such question, and a link out of step is opened again.
        first: written as soon as the connection is open, before it is drained: silences a device that another client
            left sending without being asked; what it answers is left out.
        quiet_s: silence that ends an answer without terminator and a drain, real s.
        gap_s: silence that has to stand between an answer and the next request, real s.
        harmless: bytes that may stand between two answers, such as a late terminator.
        without_news: returns what is left of bytes outside of an answer when whole messages are left out that the
            device may send at any time; None where it sends none.
        stays_writable: a link that floods is no longer read but stays open, so that something urgent can be written;
            otherwise it is closed.
        shown: returns what texts show of bytes that passed; of a protocol whose bytes hold secrets.

    Attributes:
        where: device and endpoint, for texts.
    """

    def __init__(
        self,
        transport: Transport,
        *,
        name: str,
        greet: Callable[[], Awaitable[None]],
        identify: Callable[[], Awaitable[None]] | None = None,
        first: bytes = b"",
        quiet_s: float = 0.02,
        gap_s: float = 0.0,
        harmless: bytes = b"\r\n",
        without_news: Callable[[bytes], bytes] | None = None,
        stays_writable: bool = False,
        shown: Callable[[bytes], str] = repr,
    ) -> None:
        self._transport = transport
        self.where = f"{name} at {transport.endpoint}"
        self._greet = greet
        self._identify = identify
        self._first = first
        self._quiet_s = quiet_s
        self._gap_s = gap_s
        self._answered_s = -math.inf
        self._harmless = harmless
        self._without_news = without_news
        self._stays_writable = stays_writable
        self._shown = shown
        self._losses = Losses()
        self._lock = asyncio.Lock()
        self._is_open = False
        self._doubt = ""
        self._urgent = ""
        self._received = b""
        self._floods = False
        self._ended = False
        self.discarded_bytes = 0
        self.heal_count = 0
        self.greeting = b""

    @property
    def doubt(self) -> str:
        """Why the link is out of step; empty when it is in step."""
        return self._doubt

    @property
    def last_bytes(self) -> bytes:
        """The last bytes that came in the latest exchange, bounded."""
        return self._received

    async def open(self) -> None:
        """Connect and greet.

        Raises:
            DeviceError: unreachable, or whatever the greeting finds; the link is closed then.
        """
        async with self._lock:
            self._is_open = True
            self._losses.forget()
            try:
                await self._connect()
            except (DeviceError, asyncio.CancelledError):
                await self._shut()
                raise

    async def close(self) -> None:
        """Disconnect at once, whatever is in flight; may be called any number of times."""
        await self._shut()

    async def request(
        self,
        data: bytes,
        decoder: Callable[[], Decoder[T]],
        timeout_s: float,
        *,
        repeat: Repeat = Repeat.NEVER,
        permit: Callable[[], None] | None = None,
        begun: Callable[[], None] | None = None,
    ) -> T:
        """Send a request and return its answer.

        Args:
            timeout_s: for sending and answer, real s; waiting for the turn is not counted.
            repeat: what may be done when the answer does not come or is garbage.
            permit: is asked when the request's turn has come, and again after a healing; what it raises keeps it
                from being sent.
            begun: is called once nothing keeps the request from being sent any more, right before it is.

        Raises:
            LinkTimeoutError: no answer; the link is out of step until the next request heals it.
            LinkError: not open, lost, given up or not to be healed.
            ProtocolError: garbage came.
        """

        async def once() -> T:
            async with self._lock:
                if self._gap_s:
                    await self._keep_gap()
                await self._get_in_step(heal=repeat is not Repeat.BOUND, permit=permit)
                if permit is not None:
                    permit()
                if begun is not None:
                    begun()
                return await self._exchanged(data, decoder(), timeout_s)

        return await self.repeated(once) if repeat is Repeat.HARMLESS else await once()

    async def repeated(self, work: Callable[[], Awaitable[T]]) -> T:
        """Do something harmless with this link; do it again from its beginning when an answer is lost or garbage.

        Raises:
            LinkError: unreachable, given up or lost too often.
            ProtocolError: garbage came too often.
        """
        return await repeated(work, self._losses, self.where)

    async def ensure(self) -> None:
        """Heal the link if it is out of step.

        Raises:
            DeviceError: it cannot be healed now.
        """
        async with self._lock:
            await self._get_in_step(heal=True)

    async def send(self, data: bytes, timeout_s: float) -> None:
        """Send a command that has no answer.

        Args:
            timeout_s: for sending, real s.

        Raises:
            LinkTimeoutError: the bytes are not taken; the link is out of step until the next request heals it.
            LinkError: not open or lost.
        """
        async with self._lock:
            await self._get_in_step(heal=True)
            half_sent = self._doubt = f"{self._shown(data)} may be half sent"
            await self._counted(self._transport.write(data), f"{self._shown(data)} is not taken", timeout_s)
            if self._doubt is half_sent:
                self._doubt = ""

    def send_urgent(self, data: bytes, *, cut: bytes) -> None:
        """Write past the request in flight. Its answer and this one cannot be distinguished afterwards.

        Args:
            cut: ends a request that is half written.

        Raises:
            LinkError: the link is closed or takes no bytes.
        """
        self._doubt = self._urgent = f"{self._shown(data)} was put in past a request in flight"
        self._transport.send_urgent(data, cut=cut)

    @property
    def floods(self) -> bool:
        """Whether bytes keep coming that nobody asked for; such a link is out of step and may still be written to."""
        return self._floods

    async def end_flood(self) -> None:
        """Close a link that floods; the next request heals it."""
        if self._floods:
            await self._transport.close()

    def distrust(self, why: str) -> None:
        """Have the link healed before the next request, since an answer made no sense."""
        self._losses.lost()
        self._doubt = why

    def expect_end(self, why: str) -> None:
        """Have the link opened again before the next request: the other side ends it, and nothing is lost."""
        self._ended = True
        self._doubt = why

    async def exchange(self, data: bytes, decoder: Decoder[T], timeout_s: float) -> T:
        """Send and receive while the link is held; for `greet` only, others use `request`.

        Raises:
            LinkTimeoutError: no answer in time.
            LinkError: the link is lost.
            ProtocolError: garbage came.
        """
        self._require_nothing_unasked()
        return await self._exchanged(data, decoder, timeout_s)

    async def discard(self, until_s: float) -> None:
        """Leave out what comes until then, while the link is held; for `greet` only.

        Args:
            until_s: time of the event loop, s; when it is past, only what has come already is left out.

        Raises:
            LinkError: the link is lost, or floods.
        """
        count = 0
        try:
            async with asyncio.timeout_at(until_s):
                while count <= _FLOOD_BYTES:
                    chunk = await self._transport.read()
                    self._received = chunk[:_SHOWN_BYTES]
                    count += len(chunk)
                    self.discarded_bytes += len(chunk)
        except TimeoutError:
            return
        raise await self._flooded()

    async def _exchanged(self, data: bytes, decoder: Decoder[T], timeout_s: float) -> T:
        shown = self._shown(data)
        outstanding = self._doubt = f"the answer to {shown} is outstanding"
        self._received = b""
        reply = await self._counted(self._ask(data, decoder), f"no answer to {shown}", timeout_s)
        self._losses.answered()
        self._answered_s = asyncio.get_running_loop().time()
        # `send_urgent` puts another text here meanwhile; then the doubt stays.
        if self._doubt is outstanding:
            self._doubt = self._surplus(decoder.rest)
        return reply

    async def _ask(self, data: bytes, decoder: Decoder[T]) -> T:
        await self._transport.write(data)
        reply: T | None = None
        count = 0
        while reply is None:
            if count > _FLOOD_BYTES:
                raise await self._flooded()
            try:
                chunk = await (self._soon() if decoder.may_end else self._transport.read())
            except TimeoutError:
                return decoder.end()
            count += len(chunk)
            self._received = (self._received + chunk)[-_SHOWN_BYTES:]
            reply = self._feed(decoder, chunk)
        return reply

    async def _keep_gap(self) -> None:
        await asyncio.sleep(self._answered_s + self._gap_s - asyncio.get_running_loop().time())

    async def _soon(self) -> bytes:
        async with asyncio.timeout(self._quiet_s):
            return await self._transport.read()

    def _feed(self, decoder: Decoder[T], chunk: bytes) -> T | None:
        try:
            return decoder.feed(chunk)
        except ProtocolError as exc:
            raise ProtocolError(f"{self.where}: {exc}; last bytes {self._shown(self._received)}") from None

    async def _counted(self, work: Awaitable[T], failure: str, timeout_s: float) -> T:
        """Do something within a time; count it as lost when it fails."""
        try:
            return await self._bounded(work, failure, timeout_s)
        except (LinkError, ProtocolError) as exc:
            self._losses.lost()
            self._ended |= isinstance(exc, LinkError) and not isinstance(exc, LinkTimeoutError)
            raise

    async def _bounded(self, work: Awaitable[T], failure: str, timeout_s: float) -> T:
        try:
            async with asyncio.timeout(timeout_s):
                return await work
        except TimeoutError:
            came = f"last bytes {self._shown(self._received)}" if self._received else "no byte came"
            raise LinkTimeoutError(
                f"{self.where}: {failure} within {timeout_s:g} s, {came}: check that the device "
                "is not busy or switched off; the link is opened again before the next request"
            ) from None

    async def _get_in_step(self, *, heal: bool, permit: Callable[[], None] | None = None) -> None:
        if not self._is_open:
            raise LinkError(f"{self.where}: not connected: connect first")
        self._doubt = self._doubt or self._unasked()
        if not self._doubt:
            return
        if permit is not None:
            # A stop may have left the link out of step, and is the reason that counts.
            permit()
        if not heal:
            raise NotSentError(f"{self.where}: the link is out of step ({self._doubt}): nothing was sent")
        self.heal_count += 1
        came = f"; last bytes {self._shown(self._received)}" if self._received else ""
        note_heal(self._transport, self.where, f"{self._doubt}{came}")
        if not await self._heals_in_place():
            await reopened(self._connect, self._may_be_opened)
        self._require_nothing_unasked()

    def _require_nothing_unasked(self) -> None:
        """Refuse to send after a greeting, or within one, behind which something came that nobody asked for."""
        if why := self._urgent or self._unasked():
            self._doubt = why
            raise NotSentError(f"{self.where}: the link is out of step ({why}): nothing was sent")

    async def _heals_in_place(self) -> bool:
        """Get in step on the open connection: answers come in order, so behind that to `identify` none is owed."""
        if self._identify is None or not self._can_be_read():
            return False
        for _ in range(_ATTEMPTS_IN_PLACE):
            self._urgent = ""
            try:
                await self._drain()
                await self._identify()
            except (LinkError, ProtocolError):
                if not self._can_be_read():
                    return False
            else:
                return not self._doubt
        return False

    def _can_be_read(self) -> bool:
        return not (self._ended or self._floods)

    def _may_be_opened(self) -> bool:
        return self._is_open and not self._floods and not self._losses.too_many

    async def _connect(self) -> None:
        unfinished = self._doubt = "the greeting is not finished"
        self._floods = self._ended = False
        await self._transport.close()
        try:
            await self._transport.open()
        except LinkError as exc:
            raise UnreachableError(str(exc)) from None
        # What is put in from here on has its answer on this connection.
        self._urgent = ""
        if not self._is_open:
            # `close` came while the transport was being opened and found nothing to close.
            await self._transport.close()
            raise LinkError(f"{self.where}: the link was closed while it was being opened: connect again")
        if self._first:
            await self._bounded(
                self._transport.write(self._first),
                f"{self._shown(self._first)} is not taken",
                _FIRST_TIMEOUT_S,
            )
        self.greeting = await self._drain()
        try:
            await self._greet()
        except BaseException:
            # A greeting that ends half-way leaves no session, although its last exchange may have been whole.
            self._doubt = "the greeting failed"
            raise
        if self._doubt is unfinished:
            # A device that is asked nothing owes nothing.
            self._doubt = ""

    async def _drain(self) -> bytes:
        """Read until nothing comes for the quiet time; return the first bytes."""
        first = b""
        count = 0
        try:
            async with asyncio.timeout(_DRAIN_TIMEOUT_S) as whole:
                while count <= _FLOOD_BYTES:
                    async with asyncio.timeout(self._quiet_s):
                        chunk = await self._transport.read()
                    first = (first + chunk)[:_SHOWN_BYTES]
                    count += len(chunk)
                    self.discarded_bytes += len(chunk)
        except TimeoutError:
            if not whole.expired():
                return first
        self._received = first
        raise await self._flooded()

    async def _flooded(self) -> UnreachableError:
        """Note that bytes keep coming; return the error."""
        self._floods = True
        self._doubt = "bytes keep coming without a request"
        if not self._stays_writable:
            await self._transport.close()
        return UnreachableError(
            f"{self.where}: bytes keep coming without a request, such as {self._shown(self._received)}: the link "
            "is no longer read; check that the endpoint belongs to this device and that no other program talks to it"
        )

    def _unasked(self) -> str:
        """Return what came that nobody asked for, or that the other side is gone; empty when all is well."""
        why = ""
        count = 0
        try:
            while not why and (chunk := self._transport.waiting()):
                why = self._surplus(chunk)
                count += len(chunk)
        except LinkError as exc:
            self._ended = True
            why = str(exc)
        if not why and count > _MOST_HARMLESS_BYTES:
            why = f"{count} bytes came that nobody asked for"
        return why

    def _surplus(self, data: bytes) -> str:
        """Return the doubt about bytes outside of an answer, and count them."""
        surplus = data.strip(self._harmless)
        if self._without_news is not None:
            surplus = self._without_news(surplus)
        self.discarded_bytes += len(surplus)
        return f"bytes came that nobody asked for: {self._shown(surplus[:_SHOWN_BYTES])}" if surplus else ""

    async def _shut(self) -> None:
        self._is_open = False
        self._doubt = "closed"
        await self._transport.close()
