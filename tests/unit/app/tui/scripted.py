"""An engine that sends what a test says, and notes what it is asked."""

import asyncio
import os
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import replace
from difflib import unified_diff
from pathlib import Path
from typing import Any, TypeVar

from textual.app import App
from textual.pilot import Pilot

from catseye.app.protocol.commands import CommandEvent, CommandFailed
from catseye.app.protocol.engine_events import Client
from catseye.app.protocol.events import event_of
from catseye.app.protocol.requests import AnyRequest, Control, Plain, Request
from catseye.app.protocol.snapshot import Snapshot
from catseye.app.service.command_process import Done
from catseye.app.service.errors import RefusedError
from catseye.app.store.software import SOFTWARE
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.painting import Painting
from catseye.app.tui.pictures import Pictures, Wanted
from catseye.app.tui.session import Session
from catseye.app.tui.stopping import StopOp

Asked = TypeVar("Asked", bound=Request)

GOLDEN = Path(__file__).parent / "golden"

SNAPSHOT: dict[str, Any] = {
    "engine": SOFTWARE,
    "protocol": 1,
    "pid": 0,
    "you": "tui-1",
    "clients": [{"client": "tui-1", "who": "Ada"}],
    "control": None,
    "on_client_lost": "hold",
    "run": None,
    "path": None,
    "procedure": None,
    "title": None,
    "simulated": None,
    "state": "IDLE",
    "reason": None,
    "prompt": None,
    "progress": None,
    "live": None,
    "cell": "/bench/cell.toml",
    "runs": "/bench/catseye-runs",
    "aborted": None,
}


class ScriptedLink:
    """Implements `catseye.app.tui.link.Link`: nothing comes but what a test publishes.

    Attributes:
        engine: what was published.
        cell: cell file of the next engine.
        asked: requests, in order.
        refusals: text by request; such a request is refused.
        now_s: the time of everything; a test moves it.
    """

    def __init__(self, snapshot: dict[str, Any] | None = None) -> None:
        self.engine = EngineState()
        self.cell: Path | None = Path("/bench/cell.toml")
        self.asked: list[AnyRequest] = []
        self.refusals: dict[str, str] = {}
        self.now_s = 100.0
        self.left: list[bool] = []
        self._changed: Callable[[], None] = lambda: None
        self.engine.met(snapshot_with(**(snapshot or {})), self.now_s)

    @property
    def ops(self) -> list[str]:
        """The names of the requests, in order."""
        return [request.op for request in self.asked]

    def asked_for(self, kind: type[Asked]) -> list[Asked]:
        """Return the requests of a kind, in order."""
        return [request for request in self.asked if isinstance(request, kind)]

    async def serve(self, changed: Callable[[], None]) -> None:
        """Wait for ever."""
        self._changed = changed
        changed()
        await asyncio.Event().wait()

    async def request(self, request: AnyRequest) -> None:
        """Note it, and refuse it where the test says so."""
        self.asked.append(request)
        if request.op in self.refusals:
            raise RefusedError(self.refusals[request.op])
        if isinstance(request, Control):
            self.engine.control = Client(client=self.engine.you or "", who="Ada")

    async def stop(self, op: StopOp) -> None:
        """Note it as a request."""
        await self.request(Plain(op=op))

    async def leave(self, *, end_engine: bool) -> None:
        """Note it."""
        self.left.append(end_engine)

    def publish(self, event: str, **fields: Any) -> None:
        """Have the engine send an event, with its fields as they stand on the wire."""
        message = {"t": "2026-11-21T09:00:00+00:00", "event": event, "run": None, **fields}
        self.engine.take(event_of(message), self.now_s)
        self._changed()


def snapshot_with(**fields: Any) -> Snapshot:
    """Return what an idle engine says to a client that comes, or something else of it."""
    return Snapshot.model_validate({**SNAPSHOT, **fields})


class ScriptedWork:
    """Implements `catseye.app.service.command_process.Work`: notes the commands, and answers as a test says.

    Attributes:
        done: commands, in order.
        outcomes: how a command ends, by its first word.
        held: when a command ends, by its first word; at once where nothing is said.
    """

    def __init__(self) -> None:
        self.done: list[tuple[str, ...]] = []
        self.outcomes: dict[str, Done] = {}
        self.held: dict[str, asyncio.Event] = {}

    async def do(self, *arguments: str | Path, heard: Callable[[CommandEvent], None] | None = None) -> Done:
        """Note the command."""
        words = tuple(str(argument) for argument in arguments)
        self.done.append(words)
        found = self.outcomes.get(words[0], Done(words, 0, "", ""))
        if heard is not None:
            for event in found.events:
                heard(event)
        if (over := self.held.get(words[0])) is not None:
            await over.wait()
        return replace(found, arguments=words)


def failed(code: int, text: str) -> Done:
    """Return the end of a command that reports why it failed."""
    return Done((), code, "", f"catseye: {text}\n", (CommandFailed(text=text, exit_code=code),))


class PaintedHere:
    """Implements `catseye.app.tui.pictures.Painter` in the test's own process.

    Attributes:
        wanted: what was asked for, in order.
    """

    def __init__(self) -> None:
        self.wanted: list[Wanted] = []
        self._painting = Painting()

    async def draw(self, wanted: Wanted) -> Pictures:
        """Draw at once."""
        self.wanted.append(wanted)
        return self._painting.draw(wanted)

    async def close(self) -> None:
        """Leave nothing behind: there is nothing."""


def make_app(
    link: ScriptedLink,
    screen: str = "bench",
    *,
    root: Path = Path("/bench/catseye-runs"),
    cell: Path | None = None,
) -> CatseyeApp:
    """Return the program on a scripted engine; it rehearses nothing by itself."""
    session = Session(link, ScriptedWork(), root, cell or Path("/bench/cell.toml"), lambda: link.now_s)
    session.rehearse_after_s = None
    session.painter = PaintedHere()
    app = CatseyeApp(session, screen=screen)
    # What slides to its place is drawn many times on its way.
    app.animation_level = "none"
    # On a busy machine more than the usual five seconds go by before a test looks what was said.
    app.NOTIFICATION_TIMEOUT = 3600.0  # type: ignore[misc]  # is read by the instance
    return app


@asynccontextmanager
async def started(
    snapshot: dict[str, Any] | None = None,
    screen: str = "bench",
    *,
    size: tuple[int, int] = (80, 24),
    notifications: bool = False,
    **places: Path,
) -> AsyncIterator[tuple[CatseyeApp, Pilot[Any], ScriptedLink]]:
    """Run the program in a terminal; the engine is as a snapshot says, or idle."""
    link = ScriptedLink(snapshot)
    app = make_app(link, screen, **places)
    async with app.run_test(size=size, notifications=notifications) as pilot:
        yield app, pilot, link


def work_of(app: CatseyeApp) -> ScriptedWork:
    """Return the notes about commands."""
    work = app.session.work
    assert isinstance(work, ScriptedWork)
    return work


async def settled(app: App[Any], pilot: Pilot[Any]) -> str:
    """Return the screen as text once workers have ended and it no longer changes: a layout may take two rounds."""
    await pilot.pause()
    await app.workers.wait_for_complete()
    seen: list[str] = []
    while len(seen) < 4 or len(set(seen[-3:])) > 1:
        seen.append(await shown(app, pilot))
    return seen[-1]


async def shown(app: App[Any], pilot: Pilot[Any]) -> str:
    """Return the screen as text after everything that was published is painted."""
    await pilot.pause()
    base = app.screen_stack[0]
    if hasattr(base, "show_now"):
        base.show_now()
    await pilot.pause()
    return screen_text(app)


def screen_text(app: App[Any]) -> str:
    """Return the screen as lines of text."""
    lines = app.screen._compositor.render_strips()  # noqa: SLF001  # Textual has no public way to read the screen
    return "\n".join(line.text.rstrip() for line in lines) + "\n"


def changed_screen(name: str, text: str) -> str:
    """Return how a screen differs from its golden file, empty where it does not.

    `CATSEYE_RENEW_SCREENS=1` writes the file anew, to be looked at in review.
    """
    path = GOLDEN / f"{name}.txt"
    if os.environ.get("CATSEYE_RENEW_SCREENS"):
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    if not path.is_file():
        return f"{path.name} is missing: run with CATSEYE_RENEW_SCREENS=1 and look at what it writes"
    golden = path.read_text(encoding="utf-8")
    lines = unified_diff(golden.splitlines(), text.splitlines(), path.name, "now", lineterm="")
    return "" if text == golden else "\n".join(lines) or "only the ends of lines differ"
