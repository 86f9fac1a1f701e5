"""Draws every screen in three sizes and two themes, to be looked at: python docs/every_screen.py FOLDER [SYSTEM …].

Each system's own demo leaves runs and results; then its screens are seen, on an emulated bench that stands, and Run
while a procedure measures. A picture is named after system, screen, size and theme.
"""

import asyncio
import sys
import tempfile
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import Any, Final

from screens import ARM_SERIES, ARM_SPEED
from terminal_png import write_png
from textual.pilot import Pilot
from textual.widgets import DataTable

from catseye.app.cell.templates import RESOLUTION, SIX_AXIS
from catseye.app.protocol.requests import Start, request_of
from catseye.app.service.command_process import Commands
from catseye.app.service.emulation import emulator_process
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.link import EngineLink, Link
from catseye.app.tui.main_screens import MAIN_SCREENS
from catseye.app.tui.run_state import RunState
from catseye.app.tui.session import Session
from catseye.app.tui.setup.emulators import emulated_cell
from catseye.drivers.roles.clock import SystemClock

SIZES: Final = ((80, 24), (120, 40), (200, 60))
THEMES: Final = ("catseye-dark", "catseye-light")

_SPEEDS: Final = {"scara": 20.0, RESOLUTION: ARM_SPEED, SIX_AXIS: 20.0}
_SEED: Final = 2
_LONGEST_S: Final = 900.0
_MEASURES: Final = {"scara": "reflector-search", RESOLUTION: "resolution", SIX_AXIS: "tracker-calibration"}
"""What is under way on the screen Run."""

_MEASURES_S: Final = 300.0
_ASIDE: Final = frozenset({"record", "preview", "report-of", "look", "list", "plan"})
"""Groups of workers that read or draw."""

_BEGUN: Final = 0.02
_DRAWN_S: Final = 30.0
"""For what is read and drawn aside."""

_SEEN_S: Final = 10.0
"""How long it measures before it is seen: strip and plots have something to show."""


async def main(folder: Path, systems: Sequence[str]) -> None:
    """Draw the screens of systems into a folder."""
    for system in systems:
        with tempfile.TemporaryDirectory() as name:
            made = Path(name) / "demo"
            await _demo(system, made)
            async with _opened(system, made) as (app, pilot):
                await _every_screen(app, pilot, folder, system)


async def _demo(system: str, folder: Path) -> None:
    words = ("-m", "catseye", "demo", system, "--out", str(folder))
    program = await asyncio.create_subprocess_exec(sys.executable, *words)
    if await program.wait() not in (0, 1):
        raise RuntimeError(f"the demo of {system} failed")


@asynccontextmanager
async def _opened(system: str, demo: Path) -> AsyncIterator[tuple[CatseyeApp, Pilot[Any]]]:
    cell = demo.parent / "cell.toml"
    cell.write_text(emulated_cell(system), encoding="utf-8")
    clock, root = SystemClock(), demo / "runs"
    speed = _SPEEDS[system]
    async with emulator_process(cell, speed, _SEED, None):
        link = EngineLink(root, cell, clock)
        app = CatseyeApp(Session(link, Commands(), root, cell, clock.monotonic_s, speed))
        async with app.run_test(size=SIZES[-1]) as pilot:
            await _until(pilot, lambda: link.engine.robot is not None)
            yield app, pilot
            await link.leave(end_engine=True)


async def _every_screen(app: CatseyeApp, pilot: Pilot[Any], folder: Path, system: str) -> None:
    for screen in MAIN_SCREENS:
        if screen == "run":
            await _measure(app, pilot, system)
        app.action_go(screen)
        if screen == "results":
            await _until(pilot, lambda: any(table.row_count for table in app.screen.query(DataTable)))
            await _looks(app, pilot, folder, f"{system}-results-1")
            await pilot.press("enter")
            for part in range(2, 10):
                await pilot.press(str(part))
                await _looks(app, pilot, folder, f"{system}-results-{part}")
        else:
            await _looks(app, pilot, folder, f"{system}-{screen}")


async def _measure(app: CatseyeApp, pilot: Pilot[Any], system: str) -> None:
    """Begin to measure, and answer as somebody does; a slow machine goes on without."""
    link = app.session.link
    await app.session.take_free_control()
    params = ARM_SERIES if system == RESOLUTION else {}
    await link.request(Start(procedure=_MEASURES[system], params=params, speed=_SPEEDS[system]))
    with suppress(TimeoutError):
        async with asyncio.timeout(_MEASURES_S):
            await _answering(pilot, link, SystemClock())


async def _answering(pilot: Pilot[Any], link: Link, clock: SystemClock) -> None:
    """Answer until the run has been under way for some time."""
    ends_s: float | None = None
    while ends_s is None or clock.monotonic_s() < ends_s:
        run = link.engine.run
        if run is not None and run.prompt is not None:
            text = run.prompt.choices[0] if run.prompt.choices else "yes"
            await link.request(request_of({"op": "answer", "prompt": run.prompt.id, "text": text}))
        elif ends_s is None and _share(run) > _BEGUN:
            ends_s = clock.monotonic_s() + _SEEN_S
        await pilot.pause(0.5)


def _share(run: RunState | None) -> float:
    progress = None if run is None else run.pace.progress
    return 0.0 if progress is None else progress.share


async def _looks(app: CatseyeApp, pilot: Pilot[Any], folder: Path, name: str) -> None:
    for width, height in SIZES:
        await pilot.resize_terminal(width, height)
        for theme in THEMES:
            app.theme = theme
            await pilot.pause(1.0)
            with suppress(TimeoutError):
                async with asyncio.timeout(_DRAWN_S):
                    await _drawn(app, pilot)
            look = theme.removeprefix("catseye-")
            write_png(app, folder / f"{name}-{width}x{height}-{look}.png")


async def _drawn(app: CatseyeApp, pilot: Pilot[Any]) -> None:
    """Wait until nothing is read or drawn any more."""
    while any(worker.is_running for worker in app.workers if worker.group in _ASIDE):
        await pilot.pause(0.2)


async def _until(pilot: Pilot[Any], ready: Callable[[], bool]) -> None:
    async with asyncio.timeout(_LONGEST_S):
        while not ready():
            await pilot.pause(0.2)


if __name__ == "__main__":
    Path(sys.argv[1]).mkdir(parents=True, exist_ok=True)
    asyncio.run(main(Path(sys.argv[1]), sys.argv[2:] or list(_MEASURES)))
