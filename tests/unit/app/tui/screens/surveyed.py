"""The screen of procedures on a cell that was looked at."""

import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from textual.pilot import Pilot
from textual.widgets import OptionList

from catseye.app.protocol.procedures import load_procedure
from catseye.app.results.readiness.survey_document import procedure_entry
from catseye.app.service.command_process import Done
from catseye.app.tui.app import CatseyeApp
from tests.unit.app.tui.scripted import (
    ScriptedLink,
    make_app,
    settled,
    work_of,
)
from tests.unit.app.tui.scripted_run import REHEARSAL

SIZES = [(80, 24), (120, 40)]


def facts(name: str, last: dict[str, Any] | None = None, **needs: tuple[str, str]) -> dict[str, Any]:
    """Return what the command says of a procedure that is installed."""
    entry = procedure_entry(load_procedure(name))
    return {
        **entry.model_dump(mode="json", exclude={"needs", "last"}),
        "needs": [{"what": what, "met": met, "text": text} for what, (met, text) in needs.items()],
        "last": last,
    }


def stage(name: str, state: str, *, procedure: bool = True, **more: Any) -> dict[str, Any]:
    command = f"catseye {name}"
    return {"name": name, "procedure": procedure, "state": state, "text": "", "command": command, **more}


LAST = {
    "name": "20261121T080000Z_open-loop_00beef",
    "procedure": "open-loop",
    "status": "stopped",
    "age_s": 7200.0,
    "resumable": True,
    "id": "00beef",
    "age": "2 h ago",
}
LISTED = [
    facts(
        "beam-to-j4", reflectors=("met", "P1, P2"), levelling=("advised", "none on this cell; run beam-level")
    ),
    facts(
        "open-loop",
        LAST,
        reflectors=("met", "P1, P2"),
        search=("met", "run c0ffee, 3 h ago"),
    ),
    facts("reflector-search", reflectors=("met", "P1, P2"), plan=("missing", "P2 is too near")),
]
WAY = [
    stage("beam-level", "left out"),
    stage("beam-to-j4", "done"),
    stage("reflector-search", "done"),
    stage("open-loop", "next"),
    stage("identify", "later", procedure=False),
]


def lines(stages: list[dict[str, Any]]) -> str:
    return "\n".join(json.dumps(each) for each in [*LISTED, {"cell": "lab-1", "stages": stages}])


def app_of(link: ScriptedLink, stages: list[dict[str, Any]] | None = None) -> CatseyeApp:
    app = make_app(link, "procedures")
    work_of(app).outcomes["procedures"] = Done((), 0, lines(stages or WAY), "")
    work_of(app).outcomes["run"] = REHEARSAL
    return app


@asynccontextmanager
async def procedures(
    *, size: tuple[int, int] = (80, 24), notifications: bool = False
) -> AsyncIterator[tuple[CatseyeApp, Pilot[Any], ScriptedLink]]:
    """Run the program with this screen on an idle engine."""
    link = ScriptedLink()
    app = app_of(link)
    async with app.run_test(size=size, notifications=notifications) as pilot:
        await pilot.pause()
        app.screen.query_one("#list").focus()
        yield app, pilot, link


def chosen(app: CatseyeApp) -> str | None:
    options = app.screen.query_one("#list", OptionList)
    return options.get_option_at_index(options.highlighted or 0).id


IDENTIFY = {
    "words": ["identify", "00beef", "-o", "result-00beef.json"],
    "text": "error maps from the distances",
}
DATA_WAY = [*WAY[:3], stage("open-loop", "done"), stage("identify", "next", procedure=False, **IDENTIFY)]


@asynccontextmanager
async def day(
    stages: list[dict[str, Any]], size: tuple[int, int] = (120, 40)
) -> AsyncIterator[tuple[CatseyeApp, Pilot[Any]]]:
    """Run the program with the cursor on the next stage of a day."""
    app = app_of(ScriptedLink(), stages)
    async with app.run_test(size=size, notifications=True) as pilot:
        await settled(app, pilot)
        yield app, pilot
