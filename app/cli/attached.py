"""Both ends of an attached terminal: for people, and for programs."""

import asyncio
import signal
import sys
from contextlib import ExitStack
from typing import Any

from catseye.app.cli.narrator import Narrator
from catseye.app.cli.output import emit_json, say
from catseye.app.engine.waiting import cancel
from catseye.app.errors import OutputError, exit_code_of
from catseye.app.exitcode import ExitCode
from catseye.app.service.client import EngineClient
from catseye.app.service.console import KEYS, SLASH, command_of
from catseye.app.service.errors import BadMessageError, RefusedError, ServiceError
from catseye.app.service.lines import Lines
from catseye.app.service.messages import VERSION, Message, decode_object
from catseye.app.service.questions import answer_of, prompt_of
from catseye.procedures.kit.context import Json, Prompt

PROGRAM = "attach"
_LADDER = ("hold", "stop", "abort")
_OPS = {"h": "hold", "g": "unhold", "s": "stop", "a": "abort"}


class Front:
    """What both share: events come, lines go, Ctrl-C holds and stops for whoever has control.

    Args:
        client: the connection.
        control: this client holds control.
    """

    def __init__(self, client: EngineClient, *, control: bool) -> None:
        self._client = client
        self._control = control
        self._interrupts = 0
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
                name = self._client.snapshot.get("run")
                raise ServiceError(
                    f"{self._client.closed}; look with: catseye show {name}; if it died: catseye resume {name}"
                )
            return self._code
        finally:
            await cancel(events, *self._requests)

    def told(self, event: Message) -> None:
        """Pass an event on."""
        raise NotImplementedError

    def typed(self, line: str) -> None:
        """Take a typed line."""
        raise NotImplementedError

    async def ask(self, op: str, **fields: Json) -> None:
        """Put a request; what is refused is told."""
        raise NotImplementedError

    def begin(self, op: str, **fields: Json) -> None:
        """Put a request without waiting for its answer."""
        task = asyncio.create_task(self.ask(op, **fields))
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
                self.told(event)
            except OSError as error:
                # Nobody reads any more; a client that held control is lost now, and the engine acts on it.
                self.leave(exit_code_of(error) if isinstance(error, OutputError) else ExitCode.READER_GONE)
                return
            if event["event"] == "run-ended":
                code = event.get("exit_code")
                self._code = code if isinstance(code, int) else int(ExitCode.FAULT)
                return

    def _notice(self, event: Message) -> None:
        if event["event"] == "control":
            by = event.get("by")
            self._control = isinstance(by, str) and by.endswith(f"({self._client.name})")
        elif event["event"] == "state" and event.get("state") == "EXECUTE":
            self._interrupts = 0

    def _interrupt(self) -> None:
        if not self._control:
            self.leave(ExitCode.INTERRUPTED)
            return
        self.begin(_LADDER[min(self._interrupts, len(_LADDER) - 1)])
        self._interrupts += 1


class Programs(Front):
    """Events and answers go to stdout, requests come from stdin, a line of JSON each."""

    async def follow(self) -> int:
        """Pass messages on until the run ends."""
        emit_json({"v": VERSION, "snapshot": self._client.snapshot})
        return await super().follow()

    def told(self, event: Message) -> None:
        """Write an event."""
        emit_json(event)

    def typed(self, line: str) -> None:
        """Pass a request on."""
        try:
            fields: dict[str, Any] = decode_object(line.encode(errors="replace"))
        except BadMessageError as error:
            emit_json({"v": VERSION, "re": None, "ok": False, "error": str(error)})
            return
        number, op = fields.pop("id", None), str(fields.pop("op", ""))
        fields.pop("v", None)
        self.begin(op, re=number, fields=fields)

    async def ask(self, op: str, **fields: Json) -> None:
        """Put a request and write its answer under the number that the program gave it."""
        number, given = fields.get("re"), fields.get("fields")
        answer: Message = {"v": VERSION, "re": number, "ok": True}
        try:
            found = await self._client.request(op, **(given if isinstance(given, dict) else fields))
            answer = {**found, "re": number}
        except (RefusedError, ServiceError) as error:
            answer |= {"ok": False, "error": str(error)}
        emit_json(answer)


class People(Front):
    """Events are told on stderr; lines are answers and commands.

    Args:
        client: the connection.
        control: this client holds control.
    """

    def __init__(self, client: EngineClient, *, control: bool) -> None:
        super().__init__(client, control=control)
        snapshot = client.snapshot
        self._narrator = Narrator(str(snapshot.get("procedure")), False, f"{KEYS} · q leave, each with Enter")
        self._narrator.interactive = control
        self._asked: Prompt | None = None

    async def follow(self) -> int:
        """Tell where the run stands, then what happens."""
        snapshot = self._client.snapshot
        run = snapshot["run"] or "no run is under way"
        holder = snapshot["control"]["who"] if snapshot["control"] else "nobody"
        say(f"{run}: {snapshot['state']}; control: {'you' if self._control else holder}")
        if snapshot["simulated"]:
            say("SIMULATED: every device is an emulator")
        say(
            f"{KEYS} · q leave, each with Enter"
            if self._control
            else "watching; q and Enter, or Ctrl-C, leaves"
        )
        if snapshot["prompt"]:
            self.told(snapshot["prompt"])
        return await super().follow()

    def told(self, event: Message) -> None:
        """Tell an event."""
        match event["event"]:
            case "prompt":
                self._asked = prompt_of(event)
            case "answer" | "run-ended":
                self._asked = None
            case "control":
                self._narrator.interactive = self._control
                self._narrator.tell(f"control {event['what']}: {event['by'] or 'nobody'} has it")
            case "client-lost":
                self._narrator.tell(f"{event['who']} ({event['client']}) is lost: {event['reason']}")
            case "dropped":
                self._narrator.tell(
                    f"this terminal was too slow for {event['count']} messages; the run has its data"
                )
        self._narrator.publish(event)

    def typed(self, line: str) -> None:
        """Take an answer or a command."""
        self._narrator.entered()
        asked = self._asked if self._control else None
        command = command_of(line, asked=asked is not None)
        if command == "q":
            self._quit()
        elif command in _OPS:
            self.begin(_OPS[command])
        elif command:
            self._narrator.tell(f"type {KEYS} · q leave, each with Enter")
        elif asked is not None:
            text, fault = answer_of(asked, line)
            if fault:
                self._narrator.tell(f"{fault} ({SLASH}h holds, {SLASH}s stops)")
            else:
                self.begin("answer", prompt=asked.id, text=text)

    async def ask(self, op: str, **fields: Json) -> None:
        """Put a request; tell why it is refused."""
        try:
            await self._client.request(op, **fields)
        except (RefusedError, ServiceError) as error:
            self._narrator.tell(f"{op} refused: {error}")

    def _quit(self) -> None:
        task = asyncio.create_task(self._release_and_leave())
        self._requests.add(task)
        task.add_done_callback(self._requests.discard)

    async def _release_and_leave(self) -> None:
        if self._control:
            await self.ask("release")
        self.leave(ExitCode.DONE)
