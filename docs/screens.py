"""Draws the pictures of the terminal user interface: python docs/screens.py; real screens on emulated benches.

Without arguments all systems are shown; `scara`, `resolution` or `six-axis` draws the pictures of one.
"""

import asyncio
import re
import sys
import tempfile
from collections.abc import Awaitable, Callable, Sequence
from pathlib import Path
from typing import Any, Final

from textual.pilot import Pilot
from textual.widgets import DataTable, Input, OptionList

from catseye.app.cell.templates import RESOLUTION, SIX_AXIS
from catseye.app.protocol.requests import Start, request_of
from catseye.app.service.command_process import Commands
from catseye.app.service.emulation import emulator_process
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.link import EngineLink
from catseye.app.tui.session import Session
from catseye.app.tui.setup.emulators import emulated_cell
from catseye.app.tui.widgets.record_figures import RecordFigures
from catseye.app.tui.widgets.static_text import StaticText
from catseye.drivers.roles.clock import SystemClock

_IMAGES: Final = Path(__file__).parent / "images"
_SIZE: Final = (108, 34)
_ARM_SIZE: Final = (120, 40)
"""Both plots of a series have room."""

_SPEED: Final = 80.0
ARM_SPEED: Final = 8.0
"""The counter of this bench is asked for its value: a bench that is faster than that leaves gaps in recordings."""

_TRACKER_SPEED: Final = 20.0

ARM_SERIES: Final = {
    "joints": ["A1"],
    "positions": ["K3"],
    "directions": [1],
    "steps": 75,
    "first_deg": 0.02,
    "standstill_s": 20.0,
    "dwell_s": 2.0,
    "accept_slow_counter": True,
}
_SEEN_STEPS: Final = 60
_SEED: Final = 2
_LONGEST_S: Final = 600.0
_STRIP_S: Final = 12.0
"""Long enough for the strip to fill, and for commands that a screen asks."""


async def main(systems: Sequence[str]) -> None:
    """Write the pictures of systems into docs/images."""
    for system in systems:
        speed, size, visit = _SYSTEMS[system]
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            cell = folder / "cell.toml"
            cell.write_text(emulated_cell(system), encoding="utf-8")
            async with emulator_process(cell, speed, _SEED, None):
                await _visit(folder, cell, speed, size, visit)


async def _visit(folder: Path, cell: Path, speed: float, size: tuple[int, int], visit: "Visit") -> None:
    clock, root = SystemClock(), folder / "runs"
    link = EngineLink(root, cell, clock)
    app = CatseyeApp(Session(link, Commands(), root, cell, clock.monotonic_s, speed))
    async with app.run_test(size=size) as pilot:
        await _until(pilot, lambda: link.engine.robot is not None)
        await visit(app, pilot, folder)
        await link.leave(end_engine=True)


async def _visit_scara(app: CatseyeApp, pilot: Pilot[Any], folder: Path) -> None:
    engine = app.session.link.engine
    await _run(app, pilot, "reflector-search", lambda: engine.run is not None and not engine.running)
    await pilot.pause(_STRIP_S)
    await _take(app, pilot, "bench", "bench")
    app.action_go("procedures")
    await pilot.pause(_STRIP_S)
    await _take(app, pilot, "procedures", "procedures")
    await _run(app, pilot, "open-loop", lambda: _share(app) > 0.5)
    app.action_go("run")
    await _until(pilot, lambda: any(each.pictures.titles for each in app.screen.query(RecordFigures)))
    await _take(app, pilot, "run", "run")
    await _take(app, pilot, "terminal", "terminal")
    await _until(pilot, lambda: not engine.running)
    await _take(app, pilot, "runs", "runs")
    await _jog(app, pilot)
    await _results(app, pilot, folder)
    await _wizard(app, pilot)


async def _visit_arm(app: CatseyeApp, pilot: Pilot[Any], _folder: Path) -> None:
    engine = app.session.link.engine
    before = engine.run
    await app.session.take_free_control()
    await app.session.link.request(Start(procedure="resolution", speed=app.session.speed, params=ARM_SERIES))
    await _until(pilot, lambda: engine.run is not before)
    await _answering(app, pilot, lambda: engine.run is not None and len(engine.run.staircase) > _SEEN_STEPS)
    await _take(app, pilot, "run", "run-steps")
    await _take(app, pilot, "bench", "bench-arm")


async def _visit_tracker(app: CatseyeApp, pilot: Pilot[Any], folder: Path) -> None:
    engine = app.session.link.engine
    await _questions_of_tracker(app, pilot)
    app.action_go("procedures")
    await pilot.pause(_STRIP_S)
    # What comes next is chosen when every plan has been tried.
    await _until(pilot, lambda: not app.screen.query_one("#doing", StaticText).text.plain)
    procedures = app.screen.query_one("#list", OptionList)
    procedures.focus()
    procedures.highlighted = procedures.get_option_index("tracker-calibration")
    await pilot.pause(1.0)
    await pilot.press("j")
    await _until(pilot, lambda: bool(app.screen.query("#candidates")))
    app.screen.query_one("#file", Input).value = str(folder / "poses.csv")
    await pilot.press("enter")
    await _until(pilot, lambda: app.screen.has_class("chosen"))
    await _drawn(app, pilot, "six-axis-poses")
    await pilot.press("escape")
    before = engine.run
    await app.session.take_free_control()
    await app.session.link.request(Start(procedure="tracker-calibration", speed=app.session.speed))
    await _until(pilot, lambda: engine.run is not before)
    await _answering(app, pilot, lambda: _share(app) > 0.6)
    app.action_go("run")
    await _until(pilot, lambda: any(each.pictures.titles for each in app.screen.query(RecordFigures)))
    await _drawn(app, pilot, "six-axis-run")
    await _take(app, pilot, "bench", "six-axis-bench")


async def _questions_of_tracker(app: CatseyeApp, pilot: Pilot[Any]) -> None:
    app.action_go("setup")
    await pilot.pause(1.0)
    await pilot.press("2")
    await _until(pilot, lambda: bool(app.screen.query("Wizard")))
    await pilot.press("pagedown", "pagedown")
    await _drawn(app, pilot, "six-axis-setup")
    await pilot.press("escape")


async def _answering(app: CatseyeApp, pilot: Pilot[Any], ready: Callable[[], bool]) -> None:
    """Wait, and answer each question as somebody does who has done what it asks for."""
    link = app.session.link
    async with asyncio.timeout(_LONGEST_S):
        while not ready():
            prompt = None if link.engine.run is None else link.engine.run.prompt
            if prompt is not None:
                text = prompt.choices[0] if prompt.choices else "yes"
                await link.request(request_of({"op": "answer", "prompt": prompt.id, "text": text}))
            await pilot.pause(0.5)


async def _jog(app: CatseyeApp, pilot: Pilot[Any]) -> None:
    engine = app.session.link.engine
    app.action_go("jog")
    await pilot.pause(2.0)
    await pilot.press("f8")
    # What it says is read first.
    await pilot.pause(2.0)
    await pilot.press("f8")
    await _until(pilot, lambda: engine.jogging)
    await pilot.pause(_STRIP_S)
    await _take(app, pilot, "jog", "jog")
    await pilot.press("escape")
    await _until(pilot, lambda: not engine.jogging)


async def _results(app: CatseyeApp, pilot: Pilot[Any], folder: Path) -> None:
    run = app.session.link.engine.run
    if run is None:
        raise RuntimeError("no run was seen")
    root = app.session.root
    done = await app.session.work.do("identify", run.name, "--runs", root, "-o", folder / "error-map.json")
    if done.code:
        raise RuntimeError(done.fault)
    app.action_go("results")
    # The screen is composed and its files are read after it was asked for.
    await _until(pilot, lambda: any(t.row_count for t in app.screen.query("#file-table").results(DataTable)))
    await pilot.press("enter", "2")
    await _take(app, pilot, "results", "results")


async def _wizard(app: CatseyeApp, pilot: Pilot[Any]) -> None:
    app.action_go("setup")
    await pilot.pause(1.0)
    await pilot.press("2")
    await _until(pilot, lambda: bool(app.screen.query("Wizard")))
    await pilot.press("pagedown")
    await _take(app, pilot, "setup", "setup")


async def _run(app: CatseyeApp, pilot: Pilot[Any], procedure: str, ready: Callable[[], bool]) -> None:
    link = app.session.link
    before = link.engine.run
    await app.session.take_free_control()
    await link.request(Start(procedure=procedure, speed=_SPEED))
    await _until(pilot, lambda: link.engine.run is not before and ready())


def _share(app: CatseyeApp) -> float:
    """Return how much of the run under way is done."""
    run = app.session.link.engine.run
    progress = None if run is None else run.pace.progress
    return 0.0 if progress is None else progress.share


async def _take(app: CatseyeApp, pilot: Pilot[Any], place: str, name: str) -> None:
    app.action_go(place)
    await _drawn(app, pilot, name)


async def _drawn(app: CatseyeApp, pilot: Pilot[Any], name: str) -> None:
    """Write the picture of what is shown."""
    await pilot.pause(2.0)
    svg = app.export_screenshot(title="catseye")
    # The picture stands alone: the reader's own font for monospaced text does.
    svg = re.sub(r"@font-face \{.*?\}\s*", "", svg, flags=re.DOTALL)
    (_IMAGES / f"screen-{name}.svg").write_text(svg, encoding="utf-8")


async def _until(pilot: Pilot[Any], ready: Callable[[], bool]) -> None:
    async with asyncio.timeout(_LONGEST_S):
        while not ready():
            await pilot.pause(0.2)


Visit = Callable[[CatseyeApp, Pilot[Any], Path], Awaitable[None]]

_SYSTEMS: Final[dict[str, tuple[float, tuple[int, int], Visit]]] = {
    "scara": (_SPEED, _SIZE, _visit_scara),
    RESOLUTION: (ARM_SPEED, _ARM_SIZE, _visit_arm),
    SIX_AXIS: (_TRACKER_SPEED, _ARM_SIZE, _visit_tracker),
}
"""Speed of bench time, size of the screen, and what is shown."""

if __name__ == "__main__":
    asyncio.run(main(sys.argv[1:] or list(_SYSTEMS)))
