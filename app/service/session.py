"""One client's conversation: what it asks is done as it is read, what it is sent waits for it alone."""

import asyncio
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

from catseye.app.engine.waiting import cancel
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.answers import Answer, Refusal, Welcome, encode_answer, encode_refusal
from catseye.app.protocol.events import encode_event
from catseye.app.protocol.message import MAX_LINE_BYTES, MessageError, RequestId
from catseye.app.protocol.requests import AnyRequest, Hello, decode_request
from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.errors import RefusedError, refusal_of
from catseye.app.service.mailbox import Mailbox
from catseye.app.service.member import Member, send
from catseye.app.service.request_handler import RequestHandler
from catseye.drivers.roles.clock import Clock

_READING_TURNS: Final = 10
"""Of the event loop."""


@dataclass(frozen=True)
class Patience:
    """How long a client is waited for, real s.

    Attributes:
        silence_s: without a word from a client that holds control, until it counts as lost.
        hello_s: for a client that has connected to say hello.
        flush_s: for the last messages to reach a client when the engine ends.
    """

    silence_s: float = 10.0
    hello_s: float = 2.0
    flush_s: float = 1.0


class Session:
    """Serves one connection.

    Args:
        clock: real time.
    """

    def __init__(
        self,
        registry: ClientRegistry,
        handler: RequestHandler,
        streams: tuple[asyncio.StreamReader, asyncio.StreamWriter],
        clock: Clock,
        patience: Patience,
    ) -> None:
        self._registry = registry
        self._handler = handler
        self._reader, self._writer = streams
        self._clock = clock
        self._patience = patience
        self._mailbox = Mailbox()
        self._member: Member | None = None
        self._heard_s = clock.monotonic_s()
        self._ended: asyncio.Future[str] = asyncio.get_running_loop().create_future()
        self._sending = False
        self._unwelcome = False
        # What waits for a slow client waits here, where it is counted, and not in the transport.
        self._writer.transport.set_write_buffer_limits(high=0)

    async def serve(self) -> None:
        """Talk until the client goes, or is lost."""
        tasks = [
            asyncio.create_task(part()) for part in (self._listen, self._send, self._watch, self._expect)
        ]
        for task in tasks:
            task.add_done_callback(self._part_ended)
        reason: str | None = None
        try:
            reason = await self._ended
        except Exception:
            # A fault of the program leaves nobody in control just as a broken connection does.
            reason = "its session failed"
            raise
        finally:
            try:
                # The registry learns of it before anything is waited for: a run without its client is held now.
                if self._member is not None:
                    self._registry.leave(self._member, reason)
            finally:
                self._writer.transport.abort()
                await cancel(*tasks)
                with suppress(OSError):
                    await self._writer.wait_closed()

    async def flush(self) -> None:
        """Let what waits reach the client, for a bounded time."""
        end_s = self._clock.monotonic_s() + self._patience.flush_s
        while (len(self._mailbox) or self._sending) and not self._ended.done():
            if self._clock.monotonic_s() >= end_s:
                return
            await self._clock.sleep(0.005)

    def end(self, reason: str) -> None:
        """End the conversation."""
        if not self._ended.done():
            self._ended.set_result(reason)

    @property
    def is_stranger(self) -> bool:
        """The client has not said hello."""
        return self._member is None and not self._ended.done()

    def dismiss(self, why: str) -> None:
        """Let a client go that has not said hello."""
        # It is short, and nothing else waits: the system takes it at once.
        self._writer.write(encode_refusal(None, Refusal(error=f"disconnected: {why}")))
        self.end(why)

    def _part_ended(self, task: "asyncio.Task[str | None]") -> None:
        if task.cancelled():
            return
        error = task.exception()
        if error is None:
            if (reason := task.result()) is not None:
                self.end(reason)
        elif isinstance(error, OSError):
            self.end("the connection broke")
        elif not self._ended.done():
            # A fault of the program; the engine's loop must see it, not lose it.
            self._ended.set_exception(error)

    async def _listen(self) -> str:
        while True:
            try:
                line = await self._reader.readuntil(b"\n")
            except asyncio.IncompleteReadError:
                return "it closed the connection"
            except asyncio.LimitOverrunError:
                self._say(
                    encode_refusal(None, Refusal(error=f"a line is longer than {MAX_LINE_BYTES} bytes"))
                )
                await self.flush()
                return "it sent a line that is too long"
            self._heard_s = self._clock.monotonic_s()
            if self._member is not None:
                self._member.heard_s = self._heard_s
            self._hear(line)
            if self._unwelcome:
                await self.flush()
                return "no more clients are served"
            # Lines that came together do not keep their answers, or other clients, waiting.
            await asyncio.sleep(0)

    def _hear(self, line: bytes) -> None:
        try:
            number, request = decode_request(line)
        except MessageError as error:
            self._say(encode_refusal(error.re, Refusal(error=str(error))))
            return
        try:
            found = self._answer(request)
        except RefusedError as error:
            self._refuse(number, error)
            return
        if isinstance(found, asyncio.Future):
            found.add_done_callback(lambda future: self._answer_later(number, future))
        else:
            self._say(encode_answer(number, found))

    def _answer(self, request: AnyRequest) -> "Answer | asyncio.Future[Answer]":
        if isinstance(request, Hello) and self._member is None:
            try:
                self._member = self._registry.join(request.client, request.who, self._mailbox, self.end)
            except RefusedError:
                self._unwelcome = True
                raise
            return Welcome(snapshot=self._registry.snapshot(self._member))
        return self._handler.take(self._member, request)

    def _answer_later(self, number: RequestId, future: "asyncio.Future[Answer]") -> None:
        if future.cancelled():
            self._refuse(number, RefusedError("the engine ended", ExitCode.TERMINATED))
        elif error := future.exception():
            self._refuse(number, refusal_of(error))
        else:
            self._say(encode_answer(number, future.result()))

    def _refuse(self, number: RequestId, error: RefusedError) -> None:
        self._say(encode_refusal(number, Refusal(error=str(error), exit_code=int(error.code))))

    def _say(self, answer: bytes) -> None:
        send(answer, self._mailbox, self.end)

    async def _send(self) -> str:
        while True:
            message = await self._mailbox.take()
            self._sending = True
            self._writer.write(message if isinstance(message, bytes) else encode_event(message))
            await self._writer.drain()
            self._sending = False
            # Messages that wait together do not keep a reading of the run waiting.
            await asyncio.sleep(0)

    async def _expect(self) -> None:
        """Let a client go that does not say hello in time."""
        await self._clock.sleep(self._patience.hello_s)
        # What came while this process stood still is read first.
        for _ in range(_READING_TURNS):
            await asyncio.sleep(0)
        if self.is_stranger:
            self.dismiss(f"no hello within {self._patience.hello_s:g} s")

    async def _watch(self) -> str:
        """Wait until a client that holds control has been silent for too long."""
        while True:
            silent_s = self._clock.monotonic_s() - self._heard_s
            left_s = self._patience.silence_s - silent_s
            if left_s > 0.0:
                await self._clock.sleep(left_s)
            elif self._registry.lease.held_by(self._member):
                return f"it said nothing for {silent_s:.0f} s"
            else:
                await self._clock.sleep(self._patience.silence_s / 5)
