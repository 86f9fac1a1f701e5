"""Draws the pictures of the terminal user interface: python docs/screens.py; real screens on an emulated bench."""

import asyncio
import re
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from textual.pilot import Pilot
from textual.widgets import DataTable

from catseye.app.protocol.requests import Start
from catseye.app.service.emulation import emulator_process
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.link import EngineLink
from catseye.app.tui.session import Session
from catseye.app.tui.setup.emulators import emulated_cell
from catseye.app.tui.work import Commands
from catseye.drivers.roles.clock import SystemClock

_IMAGES: Final = Path(__file__).parent / "images"
_SIZE: Final = (108, 34)
_SPEED: Final = 80.0
_SEED: Final = 2
_LONGEST_S: Final = 240.0
_STRIP_S: Final = 12.0
"""Long enough for the strip to fill, and for commands that a screen asks."""


async def main() -> None:
    """Write the pictures into docs/images."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        cell = folder / "cell.toml"
        cell.write_text(emulated_cell("scara"), encoding="utf-8")
        async with emulator_process(cell, _SPEED, _SEED, None):
            await _visit(folder, cell)


async def _visit(folder: Path, cell: Path) -> None:
    clock, root = SystemClock(), folder / "runs"
    link = EngineLink(root, cell, clock)
    app = CatseyeApp(Session(link, Commands(), root, cell, clock.monotonic_s, _SPEED))
    async with app.run_test(size=_SIZE) as pilot:
        engine = link.engine
        await _until(pilot, lambda: engine.robot is not None)
        await _run(app, pilot, "reflector-search", lambda: engine.run is not None and not engine.running)
        await pilot.pause(_STRIP_S)
        await _take(app, pilot, "bench", "bench")
        app.action_go("procedures")
        await pilot.pause(_STRIP_S)
        await _take(app, pilot, "procedures", "procedures")
        await _run(app, pilot, "open-loop", lambda: _share(app) > 0.5)
        await _take(app, pilot, "run", "run")
        await _take(app, pilot, "terminal", "terminal")
        await _until(pilot, lambda: not engine.running)
        await _take(app, pilot, "runs", "runs")
        await _jog(app, pilot)
        await _results(app, pilot, folder)
        await _wizard(app, pilot)
        await link.leave(end_engine=True)


async def _jog(app: CatseyeApp, pilot: Pilot[Any]) -> None:
    engine = app.session.link.engine
    app.action_go("jog")
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
    await pilot.press("c")
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
    if run is None or run.progress is None:
        return 0.0
    return run.progress.share


async def _take(app: CatseyeApp, pilot: Pilot[Any], place: str, name: str) -> None:
    app.action_go(place)
    await pilot.pause(2.0)
    svg = app.export_screenshot(title="catseye")
    # The picture stands alone: the reader's own font for monospaced text does.
    svg = re.sub(r"@font-face \{.*?\}\s*", "", svg, flags=re.DOTALL)
    (_IMAGES / f"screen-{name}.svg").write_text(svg, encoding="utf-8")


async def _until(pilot: Pilot[Any], ready: Callable[[], bool]) -> None:
    async with asyncio.timeout(_LONGEST_S):
        while not ready():
            await pilot.pause(0.2)


if __name__ == "__main__":
    asyncio.run(main())
