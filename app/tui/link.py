"""The connection to the engine: kept alive, begun anew when it breaks, and an engine started where there is none."""

import asyncio
import subprocess
import sys
import tempfile
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, TypeVar

from catseye.app.engine.waiting import cancel
from catseye.app.errors import StorageError
from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.engines import EngineProcess, engines_of_runs, find_engine
from catseye.app.tui.run_state import LogLine
from catseye.app.tui.stopping import StopOp, stop_by_every_way

if TYPE_CHECKING:
    # The first screen is painted before these are imported.
    from catseye.app.protocol.requests import AnyRequest
    from catseye.app.service.client import EngineClient
    from catseye.drivers.roles.clock import Clock

Answered = TypeVar("Answered")

PROGRAM = "tui"

_AGAIN_S = 1.0
"""Between two attempts to reach an engine, s."""

_LOOK_S = 0.5
"""Between two looks for a run in another process, s."""

_UNATTENDED_S = 30.0
"""How long an engine that this program started stays without any client and run, s."""

_START_S = 15.0

SILENT_S = 3.0
"""An engine that has not answered for so long is said not to answer; orders wait no longer for it."""

_LEAVE_S = 2.0
"""An engine that does not answer keeps nobody here."""


class Link(Protocol):
    """What screens ask the engine by.

    Attributes:
        engine: what it has sent.
        cell: cell file that an engine is started with; None while there is none.
    """

    engine: EngineState
    cell: Path | None

    async def serve(self, changed: Callable[[], None]) -> None:
        """Keep the connection until cancelled; `changed` is called after each message."""
        ...

    async def request(self, request: "AnyRequest") -> None:
        """Ask, and return when it is done.

        Raises:
            RefusedError: the engine does not do it; the text says why.
            ServiceError: there is no connection.
        """
        ...

    async def stop(self, op: StopOp) -> None:
        """Stop the arm, or abort the run, by every way that leads to an engine.

        Raises:
            RefusedError: nothing runs.
            ServiceError: no engine answers; the text says what was done instead.
        """
        ...

    async def leave(self, *, end_engine: bool) -> None:
        """Give control back and go; an idle engine that nobody else uses may end."""
        ...


class EngineLink:
    """Implements `Link` over the engine's socket.

    Args:
        cell: cell file of the bench; None while there is none.
        clock: real time.
        before_start: called with the cell file before an engine of it is started.
    """

    def __init__(
        self,
        root: Path,
        cell: Path | None,
        clock: "Clock",
        before_start: "Callable[[Path], Awaitable[None]] | None" = None,
    ) -> None:
        self._before_start = before_start
        self.engine = EngineState()
        self.cell = cell
        self._root = root
        self._clock = clock
        self._client: EngineClient | None = None
        self._process: EngineProcess | None = None
        self._waits: set[asyncio.Timeout] = set()
        self._left = False

    async def serve(self, changed: Callable[[], None]) -> None:
        """Keep the connection until cancelled; `changed` is called after each message."""
        while not self._left:
            try:
                trouble = await self._converse(changed)
            except (ServiceError, RefusedError, OSError) as error:
                trouble = str(error)
            self.engine.lost(trouble)
            changed()
            if not self._left:
                await self._clock.sleep(_AGAIN_S)

    async def request(self, request: "AnyRequest") -> None:
        """Ask, and return when it is done."""
        from catseye.app.protocol.requests import may_move

        await self._while_it_answers(may_move(request), lambda client: client.request(request))

    async def _while_it_answers(
        self, may_move: bool, ask: "Callable[[EngineClient], Awaitable[Answered]]"
    ) -> "Answered":
        if self._client is None:
            raise ServiceError(f"no engine is connected: {self.engine.trouble or 'wait a moment'}")
        limit_s = SILENT_S if self.engine.silent_since_s is not None else None
        if limit_s is not None and may_move:
            raise ServiceError(
                "the engine does not answer, so nothing was sent: it might act on it much later, and the arm would "
                "move unexpectedly; wait until it answers; F12 tries every way to stop the arm"
            )
        try:
            async with asyncio.timeout(limit_s) as wait:
                self._waits.add(wait)
                try:
                    return await ask(self._client)
                finally:
                    self._waits.discard(wait)
        except TimeoutError as error:
            raise ServiceError(
                "the engine does not answer, but may still carry out the request: look at the arm, and stop it by "
                "F12 if it moves"
            ) from error

    async def stop(self, op: StopOp) -> None:
        """Stop the arm, or abort the run, by every way that leads to an engine."""
        await stop_by_every_way(op, self._client, self._process, self._root)

    async def leave(self, *, end_engine: bool) -> None:
        """Give control back and go; an idle engine that nobody else uses may end."""
        self._left = True
        if self._client is None:
            return
        with suppress(RefusedError, ServiceError, TimeoutError):
            async with asyncio.timeout(_LEAVE_S):
                await self._say_goodbye(end_engine=end_engine)

    async def _say_goodbye(self, *, end_engine: bool) -> None:
        from catseye.app.protocol.requests import Control, Plain

        if end_engine and not self.engine.running and len(self.engine.clients) <= 1:
            await self.request(Control())
            await self.request(Plain(op="shutdown"))
        elif self.engine.in_control:
            await self.request(Plain(op="release"))

    async def _converse(self, changed: Callable[[], None]) -> str:
        """Be a client of an engine until it is gone, or until a run begins at another one; return which it is."""
        from catseye.app.protocol.requests import Plain

        path = await asyncio.to_thread(find_engine, self._root) or await self._start_engine()
        async with self._connected(path) as client:
            self.engine.met(client.snapshot, self._clock.monotonic_s())
            self._meet_process(client.snapshot.pid)
            changed()
            ends = [
                asyncio.create_task(self._take_events(client, changed)),
                asyncio.create_task(self._run_elsewhere(path)),
            ]
            life = asyncio.create_task(self._watch_life(client, changed))
            try:
                done, _ = await asyncio.wait(ends, return_when=asyncio.FIRST_COMPLETED)
                for task in done:
                    task.result()
            finally:
                await cancel(life, *ends)
            if client.closed is not None:
                return "the engine is gone; looking for one"
            if self.engine.in_control:
                await self.request(Plain(op="release"))
            return "a run is under way in another process; joining it"

    @asynccontextmanager
    async def _connected(self, path: Path) -> AsyncIterator["EngineClient"]:
        from catseye.app.service.client import connect

        async with AsyncExitStack() as stack:
            try:
                async with asyncio.timeout(SILENT_S):
                    client = await stack.enter_async_context(connect(path, PROGRAM, clock=self._clock))
            except TimeoutError as error:
                raise ServiceError(f"an engine listens at {path} and does not answer") from error
            self._client = client
            try:
                yield client
            finally:
                self._client = None

    async def _take_events(self, client: "EngineClient", changed: Callable[[], None]) -> None:
        from catseye.app.protocol.run_events import RunStarted

        await self._watch_bench()
        changed()
        catching_up = asyncio.create_task(self._catch_up(changed))
        try:
            async for event in client.events():
                self.engine.take(event, self._clock.monotonic_s())
                if isinstance(event, RunStarted):
                    # It may go on after an interruption.
                    catching_up.cancel()
                    catching_up = asyncio.create_task(self._catch_up(changed))
                changed()
        finally:
            catching_up.cancel()

    async def _watch_life(self, client: "EngineClient", changed: Callable[[], None]) -> None:
        """Note when the engine does not answer any more, and when it does again."""
        from catseye.app.protocol.requests import Plain

        with suppress(RefusedError, ServiceError):
            while True:
                await self._clock.sleep(_AGAIN_S)
                try:
                    async with asyncio.timeout(SILENT_S):
                        await client.request(Plain(op="ping"))
                except TimeoutError:
                    self.engine.silent_since_s = self._clock.monotonic_s() - SILENT_S
                    for wait in tuple(self._waits):
                        wait.reschedule(asyncio.get_running_loop().time())
                    changed()
                    await client.request(Plain(op="ping"))
                    self.engine.silent_since_s = None
                    changed()

    async def _run_elsewhere(self, path: Path) -> None:
        """Return when a run is under way in another process while this engine does nothing.

        It is seen twice: the socket of a run of this engine is there before its first event.
        """
        seen: Path | None = None
        while True:
            await self._clock.sleep(_LOOK_S)
            engine = self.engine
            if engine.running or engine.jogging or engine.raw or self._waits:
                seen = None
                continue
            found = await asyncio.to_thread(engines_of_runs, self._root)
            newest = found[0] if found and found[0] != path else None
            if newest is not None and newest == seen:
                return
            seen = newest

    def _meet_process(self, pid: int) -> None:
        if self._process is not None:
            self._process.forget()
        self._process = EngineProcess(pid)

    async def _catch_up(self, changed: Callable[[], None]) -> None:
        """Read from the record of a run under way what happened before this client came."""
        from catseye.app.tui.record import read_record

        run = self.engine.run
        if run is None or not run.active:
            return
        path = Path(run.path) if run.path else self._root / run.name
        try:
            so_far = await asyncio.to_thread(read_record, path)
        except StorageError as error:
            run.log.append(LogLine("", "warning", f"earlier events are not known: {error}"))
        else:
            run.take_record(so_far)
        changed()

    async def _watch_bench(self) -> None:
        """Ask for the bench; control is taken by whoever wants to do something."""
        from catseye.app.protocol.answers import Watching
        from catseye.app.protocol.requests import Watch

        with suppress(RefusedError):
            seen = await self._while_it_answers(False, lambda client: client.ask(Watch(op="watch"), Watching))
            if seen.bench is not None:
                self.engine.take_bench(seen.bench, self._clock.monotonic_s())

    async def _start_engine(self) -> Path:
        """Start an engine that outlives this program; return its socket.

        Raises:
            ServiceError: there is no cell file, or it does not come up; the text is what it said.
        """
        if self.cell is None:
            raise ServiceError("there is no cell file yet: set one up (F10), or try the demo")
        if self._before_start is not None:
            await self._before_start(self.cell)
        arguments = ["engine", "--cell", str(self.cell), "--runs", str(self._root)]
        arguments += ["--wait-for-client", str(_UNATTENDED_S)]
        # A pipe that nobody reads would hold the engine up when it is full.
        with tempfile.TemporaryFile() as said:
            process = await asyncio.create_subprocess_exec(
                sys.executable,
                "-P",
                "-m",
                "catseye",
                *arguments,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=said,
                start_new_session=True,
            )
            for _ in range(round(_START_S / 0.05)):
                await self._clock.sleep(0.05)
                if (path := await asyncio.to_thread(find_engine, self._root)) is not None:
                    return path
                if process.returncode is not None:
                    break
            said.seek(0)
            text = said.read().decode(errors="replace").strip()
        raise ServiceError(f"the engine did not start: {text or 'no answer'}")
