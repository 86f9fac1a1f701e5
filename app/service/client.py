"""A client of an engine, for front ends and scripts."""

import asyncio
import getpass
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import Any

from catseye.app.engine.waiting import cancel
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.answers import Found, Welcome, answer_as
from catseye.app.protocol.events import AnyEvent, received_event
from catseye.app.protocol.message import JsonObject, MessageError, decode_object, require_version
from catseye.app.protocol.requests import (
    AnyRequest,
    Control,
    Hello,
    Plain,
    Reply,
    encode_request,
)
from catseye.app.protocol.snapshot import Snapshot
from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.service.mailbox import Mailbox, MailboxFullError
from catseye.drivers.roles.clock import Clock, SystemClock

_LONGEST_BYTES = 16 * 1024 * 1024
"""A snapshot or event is long when a run's title or a prompt is."""

PING_S = 2.0
"""Real s between two signs of life."""


_READING_TURNS = 10
"""Of the event loop. A process that stood still reads first what came meanwhile: a line that is written to an engine
that has gone breaks the connection, and what was not read is lost."""


class EngineClient:
    """A connection to an engine. Made by `connect`.

    Args:
        clock: real time.

    Attributes:
        closed: why the connection is closed; None while it is open.
        inbox: events that wait to be read.
        snapshot: what the engine said at the beginning.
    """

    snapshot: Snapshot

    def __init__(self, streams: tuple[asyncio.StreamReader, asyncio.StreamWriter], clock: Clock) -> None:
        self._reader, self._writer = streams
        self._clock = clock
        self.inbox = Mailbox()
        self._waiting: dict[int, asyncio.Future[JsonObject]] = {}
        self._count = 0
        self.closed: str | None = None

    async def request(self, request: AnyRequest) -> JsonObject:
        """Put a request and return its answer.

        Raises:
            RefusedError: the engine does not do it; the text says why.
            ServiceError: the connection is closed.
        """
        if self.closed is not None:
            raise ServiceError(self.closed)
        self._count += 1
        number = self._count
        future: asyncio.Future[JsonObject] = asyncio.get_running_loop().create_future()
        self._waiting[number] = future
        try:
            self._writer.write(encode_request(number, request))
            await self._writer.drain()
            answer = await future
        except OSError as error:
            raise ServiceError(f"the engine is gone: {error}") from error
        finally:
            del self._waiting[number]
        if answer.get("ok") is not True:
            code = answer.get("exit_code")
            raise RefusedError(
                str(answer.get("error")), ExitCode(code) if isinstance(code, int) else ExitCode.USAGE
            )
        return answer

    async def ask(self, request: AnyRequest, kind: type[Found]) -> Found:
        """Put a request and return what its answer carries.

        Raises:
            RefusedError: the engine does not do it; the text says why.
            ServiceError: the connection is closed, or the engine answers something else.
        """
        try:
            return answer_as(kind, await self.request(request))
        except MessageError as error:
            raise ServiceError(
                f"the engine answers otherwise than this program ({error}): use the same catseye on both sides"
            ) from error

    async def events(self) -> AsyncIterator[AnyEvent]:
        """Yield what happens, until the connection is closed."""
        while True:
            try:
                event = await self.inbox.take()
            except EOFError:
                return
            if not isinstance(event, bytes):
                yield event

    async def take_control(self, *, force: bool = False) -> None:
        """Take control.

        Raises:
            RefusedError: somebody else has it.
        """
        await self.request(Control(take=True, force=force))

    async def release(self) -> None:
        """Give control back; the run goes on as it is."""
        await self.request(Plain(op="release"))

    async def answer(self, prompt: str, text: str) -> None:
        """Answer a prompt.

        Raises:
            RefusedError: it is not open, or this is no answer to it.
        """
        await self.request(Reply(prompt=prompt, text=text))

    async def listen(self) -> None:
        """Take in what the engine sends, until the connection is closed."""
        try:
            while line := await self._reader.readline():
                self.receive(decode_object(line))
            self._close("the engine closed the connection")
        except (OSError, ValueError, MailboxFullError) as error:
            self._close(f"the connection to the engine ended: {error}")

    @property
    def name(self) -> str:
        """By which the engine knows this client."""
        return self.snapshot.you or ""

    async def keep_alive(self) -> None:
        """Give signs of life until the connection is closed."""
        while self.closed is None:
            await self._clock.sleep(PING_S)
            for _ in range(_READING_TURNS):
                await asyncio.sleep(0)
            try:
                await self.request(Plain(op="ping"))
            except (RefusedError, ServiceError):
                return

    def receive(self, message: dict[str, Any]) -> None:
        """Take in a message of the engine.

        Raises:
            MessageError: it is of another version, or has no shape of a message.
            MailboxFullError: too many events wait to be read.
        """
        require_version(message)
        number = message.get("re")
        if "event" in message:
            self.inbox.put(received_event(message))
        elif isinstance(number, int) and number in self._waiting and not self._waiting[number].done():
            self._waiting[number].set_result(message)
        elif number is None:
            # The engine could not even read which request it was; the oldest one waits no longer.
            for future in self._waiting.values():
                if not future.done():
                    future.set_result(message)
                    break

    def _close(self, reason: str) -> None:
        self.closed = reason
        for future in self._waiting.values():
            if not future.done():
                future.set_exception(ServiceError(reason))
        self.inbox.close()
        self._writer.transport.abort()


@asynccontextmanager
async def connect(
    path: Path, program: str, who: str | None = None, clock: Clock | None = None
) -> AsyncIterator[EngineClient]:
    """Connect to an engine and say hello.

    Args:
        who: the person; the user of this process when left out.
        clock: real time.

    Raises:
        ServiceError: nobody listens there.
        RefusedError: the engine speaks another version.
    """
    try:
        streams = await asyncio.open_unix_connection(path, limit=_LONGEST_BYTES)
    except OSError as error:
        raise ServiceError(f"{path}: no engine listens there: {error}") from error
    async with over(streams, program, who or getpass.getuser(), clock or SystemClock()) as client:
        yield client


@asynccontextmanager
async def over(
    streams: tuple[asyncio.StreamReader, asyncio.StreamWriter], program: str, who: str, clock: Clock
) -> AsyncIterator[EngineClient]:
    """Be a client over an open connection."""
    client = EngineClient(streams, clock)
    tasks = [asyncio.create_task(client.listen())]
    try:
        client.snapshot = (await client.ask(Hello(client=program, who=who), Welcome)).snapshot
        tasks.append(asyncio.create_task(client.keep_alive()))
        yield client
    finally:
        streams[1].transport.abort()
        await cancel(*tasks)
        with suppress(OSError):
            await streams[1].wait_closed()
