"""The connection to the engine: kept alive, begun anew when it breaks, and an engine started where there is none."""

import asyncio
import os
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from app.tui.picture import Picture
from app.tui.run_picture import LogLine

if TYPE_CHECKING:
    # The first screen is painted before these are imported.
    from app.service.client import EngineClient
    from drivers.clock import Clock

PROGRAM = "tui"

_AGAIN_S = 1.0
"""Between two attempts to reach an engine, s."""

_UNATTENDED_S = 30.0
"""How long an engine that this program started stays without any client and run, s."""

_START_S = 15.0


class Link(Protocol):
    """What screens ask the engine by.

    Attributes:
        picture: what it has told.
        cell: cell file that an engine is started with; None while there is none.
    """

    picture: Picture
    cell: Path | None

    async def serve(self, changed: Callable[[], None]) -> None:
        """Keep the connection until cancelled; `changed` is called after each message."""
        ...

    async def request(self, op: str, **fields: Any) -> dict[str, Any]:
        """Ask, and return what the answer carries.

        Raises:
            RefusedError: the engine does not do it; the text says why.
            ServiceError: there is no connection.
        """
        ...

    async def leave(self, *, end_engine: bool) -> None:
        """Give control back and go; an idle engine that nobody else uses may end."""
        ...


class EngineLink:
    """Implements `Link` over the engine's socket.

    Args:
        root: folder of all runs.
        cell: cell file of the bench; None while there is none.
        clock: real time.
    """

    def __init__(self, root: Path, cell: Path | None, clock: "Clock") -> None:
        self.picture = Picture()
        self.cell = cell
        self._root = root
        self._clock = clock
        self._client: EngineClient | None = None
        self._left = False

    async def serve(self, changed: Callable[[], None]) -> None:
        """Keep the connection until cancelled; `changed` is called after each message."""
        from app.service.errors import RefusedError, ServiceError

        while not self._left:
            try:
                await self._converse(changed)
                trouble = "the engine is gone; looking for it"
            except (ServiceError, RefusedError, OSError) as error:
                trouble = str(error)
            self.picture.lost(trouble)
            changed()
            if not self._left:
                await self._clock.sleep(_AGAIN_S)

    async def request(self, op: str, **fields: Any) -> dict[str, Any]:
        """Ask, and return what the answer carries."""
        from app.service.errors import ServiceError

        if self._client is None:
            raise ServiceError(f"no engine is connected: {self.picture.trouble or 'wait a moment'}")
        return await self._client.request(op, **fields)

    async def leave(self, *, end_engine: bool) -> None:
        """Give control back and go; an idle engine that nobody else uses may end."""
        from app.service.errors import RefusedError, ServiceError

        self._left = True
        if self._client is None:
            return
        with suppress(RefusedError, ServiceError):
            if end_engine and not self.picture.running and await self._is_alone():
                await self.request("shutdown")
            elif self.picture.in_control:
                await self.request("release")

    async def _is_alone(self) -> bool:
        answer = await self.request("ping")
        clients = answer.get("clients", self.picture.clients)
        return len(clients) <= 1

    async def _converse(self, changed: Callable[[], None]) -> None:
        from app.service.client import connect

        path = await asyncio.to_thread(_socket_of, self._root)
        if path is None:
            path = await self._start_engine()
        catching_up: asyncio.Task[None] | None = None
        async with connect(path, PROGRAM, clock=self._clock) as client:
            self._client = client
            try:
                self.picture.met(client.snapshot, self._clock.monotonic_s())
                changed()
                await self._take_what_is_free()
                catching_up = asyncio.create_task(self._catch_up(changed))
                async for event in client.events():
                    self.picture.take(event, self._clock.monotonic_s())
                    if event["event"] == "run-started":
                        # It may go on after an interruption.
                        catching_up.cancel()
                        catching_up = asyncio.create_task(self._catch_up(changed))
                    changed()
            finally:
                self._client = None
                if catching_up is not None:
                    catching_up.cancel()

    async def _catch_up(self, changed: Callable[[], None]) -> None:
        """Read from the record of a run under way what happened before this client came."""
        from app.errors import StorageError
        from app.tui.record import read_record

        run = self.picture.run
        if run is None or not run.active:
            return
        path = Path(run.path) if run.path else self._root / run.name
        try:
            so_far = await asyncio.to_thread(read_record, path)
        except StorageError as error:
            run.log.append(LogLine("", "warning", f"what happened before is not known: {error}"))
        else:
            run.take_record(so_far)
        changed()

    async def _take_what_is_free(self) -> None:
        """Ask to be told about the bench; control is taken by whoever wants to do something."""
        from app.service.errors import RefusedError

        with suppress(RefusedError):
            answer = await self.request("watch", on=True)
            if isinstance(answer.get("bench"), dict):
                self.picture.take({"event": "bench", **answer["bench"]}, self._clock.monotonic_s())

    async def _start_engine(self) -> Path:
        """Start an engine that outlives this program; return its socket.

        Raises:
            ServiceError: there is no cell file, or it does not come up; the text is what it said.
        """
        from app.service.errors import ServiceError

        if self.cell is None:
            raise ServiceError("there is no cell file yet: set one up (F10), or try the demo")
        arguments = ["engine", "--cell", str(self.cell), "--runs", str(self._root)]
        arguments += ["--wait-for-client", str(_UNATTENDED_S)]
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-m",
            "app",
            *arguments,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )
        for _ in range(round(_START_S / 0.05)):
            await self._clock.sleep(0.05)
            if (path := _socket_of(self._root)) is not None:
                return path
            if process.returncode is not None:
                break
        said = b"" if process.stderr is None or process.returncode is None else await process.stderr.read()
        raise ServiceError(
            f"the engine did not start: {said.decode(errors='replace').strip() or 'no answer'}"
        )

    def abort_by_signal(self) -> bool:
        """Abort by a signal to the engine's process, past its socket; return whether there was one to send to."""
        import signal

        pid = self.picture.facts.get("pid")
        if not isinstance(pid, int) or pid == os.getpid():
            return False
        with suppress(ProcessLookupError, PermissionError):
            os.kill(pid, signal.SIGTERM)
            return True
        return False


def _socket_of(root: Path) -> Path | None:
    """Return the socket of the newest run under way, else of the engine of a folder of runs."""
    from app.service.address import find_socket
    from app.store.catalog import list_runs

    under_way = [run for run in list_runs(root) if run.status == "running"]
    found = (find_socket(run.path) for run in reversed(under_way))
    return next((path for path in found if path is not None), None) or find_socket(root)
