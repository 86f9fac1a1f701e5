"""Both ends of an attached terminal, for people and for programs, and where their engine listens."""

import asyncio
import signal
import sys
from collections.abc import Coroutine
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Final

from catseye.app.cli.going_on import say_how_to_go_on
from catseye.app.cli.narrator import Narrator
from catseye.app.cli.output import note, write_document
from catseye.app.engine.waiting import cancel
from catseye.app.errors import OutputError, UsageError, exit_code_of
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.answers import Refusal, refused
from catseye.app.protocol.banners import SIMULATION_TEXT
from catseye.app.protocol.engine_events import ClientLost, ControlChanged, Dropped
from catseye.app.protocol.events import AnyEvent, Unknown, Unread, passed_over_text
from catseye.app.protocol.message import VERSION, JsonObject, MessageError, RequestId, decode_object
from catseye.app.protocol.requests import AnyRequest, Plain, Reply, request_of
from catseye.app.protocol.run_events import PromptAnswered, PromptAsked, RunEnded
from catseye.app.service.address import all_sockets, find_socket
from catseye.app.service.client import EngineClient, connect
from catseye.app.service.console import KEYS, SLASH, command_of
from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.service.lines import Lines
from catseye.app.service.questions import answer_of
from catseye.app.store.reader import Accept, RunReader
from catseye.app.store.software import SOFTWARE, other_version_text
from catseye.procedures.kit.context import Prompt

PROGRAM = "attach"
_REQUESTS: Final = {
    "h": Plain(op="hold"),
    "g": Plain(op="unhold"),
    "s": Plain(op="stop"),
    "a": Plain(op="abort"),
}


class Front:
    """What both share: events come, lines go, Ctrl-C holds and stops for whoever has control."""

    def __init__(self, client: EngineClient, *, control: bool) -> None:
        self._client = client
        self._control = control
        self._code: int | None = None
        self._left: asyncio.Future[int] = asyncio.get_running_loop().create_future()
        self._requests: set[asyncio.Task[None]] = set()

    async def follow(self) -> int:
        """Pass events on until the run ends or the person leaves; return the exit code.

        Raises:
            ServiceError: the connection ended before the run did.
        """
        loop = asyncio.get_running_loop()
        events = asyncio.create_task(self._events())
        try:
            with ExitStack() as stack:
                loop.add_signal_handler(signal.SIGINT, self._interrupt)
                stack.callback(loop.remove_signal_handler, signal.SIGINT)
                stack.enter_context(Lines(sys.stdin.fileno(), self.typed).read())
                ways_out: set[asyncio.Future[Any]] = {events, self._left}
                await asyncio.wait(ways_out, return_when=asyncio.FIRST_COMPLETED)
            if self._left.done():
                return self._left.result()
            events.result()
            if self._code is None:
                name = self._client.snapshot.run
                raise ServiceError(
                    f"{self._client.closed}; look with: catseye show {name}; if it died: catseye resume {name}"
                )
            return self._code
        finally:
            await cancel(events, *self._requests)

    def show(self, event: AnyEvent) -> None:
        """Pass an event on."""
        raise NotImplementedError

    def typed(self, line: str) -> None:
        """Take a typed line."""
        raise NotImplementedError

    async def ask(self, request: AnyRequest) -> None:
        """Put a request; a refusal is shown."""
        raise NotImplementedError

    def begin(self, work: Coroutine[Any, Any, None]) -> None:
        """Put a request without waiting for its answer."""
        task = asyncio.create_task(work)
        self._requests.add(task)
        task.add_done_callback(self._requests.discard)

    def leave(self, code: int) -> None:
        """End with an exit code."""
        if not self._left.done():
            self._left.set_result(code)

    async def _events(self) -> None:
        async for event in self._client.events():
            self._notice(event)
            try:
                self.show(event)
            except OSError as error:
                # Nobody reads any more; a client that held control is lost now, and the engine acts on it.
                self.leave(exit_code_of(error) if isinstance(error, OutputError) else ExitCode.READER_GONE)
                return
            if isinstance(event, RunEnded):
                self._code = event.exit_code
                return

    def _notice(self, event: AnyEvent) -> None:
        if isinstance(event, ControlChanged):
            self._control = event.holder is not None and event.holder.client == self._client.name

    def _interrupt(self) -> None:
        if self._control:
            self.begin(self.ask(Plain(op="ladder")))
        else:
            self.leave(ExitCode.INTERRUPTED)


class Programs(Front):
    """Events and answers go to stdout, requests come from stdin, a line of JSON each."""

    async def follow(self) -> int:
        """Pass messages on until the run ends."""
        write_document("attached", {"v": VERSION, "snapshot": self._client.snapshot.json_object()})
        return await super().follow()

    def show(self, event: AnyEvent) -> None:
        """Write an event."""
        write_document("attached", {"v": VERSION, **event.json_object()})

    def typed(self, line: str) -> None:
        """Pass a request on."""
        number = None
        try:
            fields = decode_object(line.encode(errors="replace"))
            fields.pop("v", None)
            number = fields.pop("id", None)
            request = request_of(fields)
        except MessageError as error:
            write_document("attached", refused(number, Refusal(error=str(error))))
            return
        self.begin(self._answer(number, request))

    async def ask(self, request: AnyRequest) -> None:
        """Put a request of this terminal, whose answer has no number."""
        await self._answer(None, request)

    async def _answer(self, number: RequestId | None, request: AnyRequest) -> None:
        """Put a request and write its answer under the number that the program gave it."""
        answer: JsonObject
        try:
            answer = {**await self._client.request(request), "re": number}
        except (RefusedError, ServiceError) as error:
            answer = refused(number, Refusal(error=str(error)))
        write_document("attached", answer)


class People(Front):
    """Events are shown on stderr; lines are answers and commands."""

    def __init__(self, client: EngineClient, *, control: bool) -> None:
        super().__init__(client, control=control)
        go_on = f"{KEYS} · q leave, each with Enter"
        self._narrator = Narrator(client.snapshot.procedure or "", False, go_on)
        self._narrator.interactive = control
        self._asked: Prompt | None = None
        self._passed_over: set[str] = set()

    async def follow(self) -> int:
        """Say where the run stands, then what happens."""
        snapshot = self._client.snapshot
        run = snapshot.run or "no run is under way"
        holder = snapshot.control.who if snapshot.control else "nobody"
        note(f"{run}: {snapshot.state}; control: {'you' if self._control else holder}", heard=True)
        if snapshot.engine != SOFTWARE:
            note(other_version_text(snapshot.engine), heard=True)
        if snapshot.simulated:
            note(SIMULATION_TEXT, heard=True)
        note(
            f"{KEYS} · q leave, each with Enter"
            if self._control
            else "watching; q and Enter, or Ctrl-C, leaves",
            heard=True,
        )
        if snapshot.prompt:
            self.show(snapshot.prompt)
        return await super().follow()

    def show(self, event: AnyEvent) -> None:
        """Show an event."""
        match event:
            case PromptAsked():
                self._asked = event.prompt
            case PromptAnswered() | RunEnded():
                self._asked = None
            case ControlChanged():
                self._narrator.interactive = self._control
                self._narrator.show(f"control {event.what}: {event.by or 'nobody'} has it")
            case ClientLost():
                self._narrator.show(f"{event.who} ({event.client}) is lost: {event.reason}")
            case Unknown() | Unread():
                self._pass_over(passed_over_text(event))
            case Dropped():
                self._narrator.show(
                    f"this terminal was too slow for {event.count} messages; the run has its data"
                )
        self._narrator.publish(event)
        if isinstance(event, RunEnded) and event.exit_code != ExitCode.DONE:
            say_how_to_go_on(Path(event.path))

    def _pass_over(self, text: str) -> None:
        """Say once what this program cannot show."""
        if text not in self._passed_over:
            self._passed_over.add(text)
            self._narrator.show(text)

    def typed(self, line: str) -> None:
        """Take an answer or a command."""
        self._narrator.entered()
        asked = self._asked if self._control else None
        command = command_of(line, asked)
        if command == "q":
            self.begin(self._release_and_leave())
        elif command in _REQUESTS:
            self.begin(self.ask(_REQUESTS[command]))
        elif command:
            self._narrator.show(f"type {KEYS} · q leave, each with Enter")
        elif asked is not None:
            text, fault = answer_of(asked, line)
            if fault:
                self._narrator.show(f"{fault} ({SLASH}h holds, {SLASH}s stops)")
            else:
                self.begin(self.ask(Reply(prompt=asked.id, text=text)))

    async def ask(self, request: AnyRequest) -> None:
        """Put a request; show why it is refused."""
        try:
            await self._client.request(request)
        except (RefusedError, ServiceError) as error:
            self._narrator.show(f"{request.op} refused: {error}")

    async def _release_and_leave(self) -> None:
        if self._control:
            await self.ask(Plain(op="release"))
        self.leave(ExitCode.DONE)


def socket_of(run: Path) -> Path:
    """Return the socket of a run that is under way.

    Raises:
        UsageError: it is over, or died.
        ServiceError: it is under way and has no socket.
    """
    status = RunReader(run, Accept.UNCHECKED).status
    if status == "complete":
        raise UsageError(f"{run.name} is complete: see it with: catseye show {run.name}")
    if status != "running":
        raise UsageError(
            f"{run.name} is over, its state is {status}: go on with it with: catseye resume {run.name}"
        )
    path = find_socket(run)
    if path is None:
        raise ServiceError(
            f"{run.name} is under way and serves no socket: its log says why; stop it with a signal"
        )
    return path


def _works_in(root: Path, run: str | None, runs: str | None) -> bool:
    """Return whether an engine, with its run or without one, works in a folder of runs."""
    place = Path(run).parent if run else Path(runs or "")
    return place.resolve() == root.resolve()


async def only_engine(root: Path) -> Path:
    """Return the socket of the only engine of a folder of runs.

    Raises:
        UsageError: there is none, or several.
    """
    found: list[tuple[str, Path]] = []
    for path in all_sockets():
        try:
            async with connect(path, PROGRAM) as client:
                run, runs = client.snapshot.path, client.snapshot.runs
                if _works_in(root, run, runs):
                    found.append((str(run or runs), path))
        except (ServiceError, RefusedError):
            continue
    if len(found) == 1:
        return found[0][1]
    if not found:
        raise UsageError(
            f"no engine works in {root}: start a run with catseye run, or name another folder with --runs"
        )
    raise UsageError(f"several engines work in {root}: name one of {', '.join(place for place, _ in found)}")
