"""The run screen on a scripted engine, and what was asked of that."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from textual.pilot import Pilot

from catseye.app.protocol.requests import Reply
from catseye.app.tui.app import CatseyeApp
from tests.unit.app.tui import scripted
from tests.unit.app.tui.scripted import ScriptedLink, make_app, shown, work_of
from tests.unit.app.tui.scripted_run import REHEARSAL, SNAPSHOT


def app_of(link: ScriptedLink) -> CatseyeApp:
    app = make_app(link, "run")
    work_of(app).outcomes["run"] = REHEARSAL
    return app


@asynccontextmanager
async def run_screen(
    snapshot: dict[str, Any] = SNAPSHOT, *, size: tuple[int, int] = (80, 24)
) -> AsyncIterator[tuple[CatseyeApp, Pilot[Any], ScriptedLink]]:
    """Run the program with the screen of a run; the engine is as a snapshot says."""
    link = ScriptedLink(snapshot)
    app = app_of(link)
    async with app.run_test(size=size) as pilot:
        yield app, pilot, link


async def settled(app: CatseyeApp, pilot: Pilot[Any], link: ScriptedLink) -> str:
    """Return the screen as it is after a second; after another one a question was read and takes answers."""
    await scripted.settled(app, pilot)
    link.now_s += 1.0
    text = await shown(app, pilot)
    link.now_s += 1.0
    return text


def answers(link: ScriptedLink) -> list[tuple[str, str]]:
    return [(reply.prompt, reply.text) for reply in link.asked_for(Reply)]


def ops(link: ScriptedLink) -> list[str]:
    return link.ops
