"""The run screen on a scripted engine, and what was asked of that."""

from typing import Any

from textual.pilot import Pilot

from catseye.app.tui.app import CatseyeApp
from tests.unit.app.tui.scripted import ScriptedLink, make_app, shown, work_of
from tests.unit.app.tui.scripted_run import REHEARSAL


def app_of(link: ScriptedLink) -> CatseyeApp:
    app = make_app(link, "run")
    work_of(app).outcomes["run"] = REHEARSAL
    return app


async def settled(app: CatseyeApp, pilot: Pilot[Any], link: ScriptedLink) -> str:
    """Have everything be painted and half a second pass, so that a question takes answers."""
    await shown(app, pilot)
    await app.workers.wait_for_complete()
    await shown(app, pilot)
    link.now_s += 1.0
    return await shown(app, pilot)


def answers(link: ScriptedLink) -> list[tuple[str, str]]:
    return [(request["prompt"], request["text"]) for request in link.asked if request["op"] == "answer"]


def ops(link: ScriptedLink) -> list[str]:
    return [str(request["op"]) for request in link.asked]
