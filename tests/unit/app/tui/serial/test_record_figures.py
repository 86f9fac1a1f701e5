"""Pictures of a run under way on a serial arm: what its record shows so far."""

import asyncio
from pathlib import Path
from typing import cast

import pytest
from textual.app import App, ComposeResult
from textual.pilot import Pilot

from catseye.app.results.figures import Figure
from catseye.app.results.serial_arm.axis_report import axis_section
from catseye.app.results.serial_arm.ballbar_report import ballbar_section
from catseye.app.store.reader import RunReader
from catseye.app.tui.run_state import RunState, Step
from catseye.app.tui.serial.record_figures import RecordFigures
from catseye.app.tui.widgets.figure_view import Figures, FigureView
from catseye.app.tui.widgets.static_text import StaticText
from tests.unit.app.results.serial_arm.test_ballbar_report import Readings
from tests.unit.app.results.serial_arm.test_run_poses import validated
from tests.unit.app.results.serial_arm.test_run_report import turned
from tests.unit.app.tui.scripted import changed_screen, settled
from tests.unit.procedures.serial_arm.benches import Room

SIZES = [(80, 24), (120, 40)]


class Shown(App[None]):
    """The widget alone."""

    def compose(self) -> ComposeResult:
        yield RecordFigures(id="record-plots")

    @property
    def figures(self) -> list[str]:
        return [figure.key for figure in self.query_one(FigureView).figures]

    @property
    def note(self) -> str:
        return self.query_one("#record-note", StaticText).text.plain

    async def show(self, run: RunState | None, root: Path) -> None:
        self.query_one(RecordFigures).show(run, root)
        await self.workers.wait_for_complete()


def run_of(path: Path, done: int = 1) -> RunState:
    run = RunState(path.name, "tracker-validation", "Validation", 0.0)
    run.steps = {str(number): Step(str(number), "", "done") for number in range(done)}
    return run


@pytest.fixture
async def measured(tmp_path: Path) -> Path:
    return await validated(tmp_path)


async def test_figures_of_the_record_are_drawn(measured: Path) -> None:
    app = Shown()
    async with app.run_test(size=(80, 30)):
        await app.show(run_of(measured), measured.parent)
        assert app.figures == ["pose-places", "pose-arrows", "pose-differences"]
        assert app.note == ""


async def test_a_record_that_is_being_read_is_not_empty(measured: Path) -> None:
    app = Shown()
    async with app.run_test(size=(80, 30)):
        app.query_one(RecordFigures).show(run_of(measured), measured.parent)
        assert app.note == "reading the record …"
        await app.workers.wait_for_complete()
        assert (bool(app.figures), app.note) == (True, "")


async def test_a_run_that_begins_has_no_figures(measured: Path) -> None:
    app = Shown()
    async with app.run_test(size=(80, 30)):
        await app.show(run_of(measured), measured.parent)
        await app.show(run_of(measured.parent / "next", 0), measured.parent)
        assert (app.figures, app.note) == ([], "nothing measured yet")


async def test_before_the_first_run_there_are_no_figures(tmp_path: Path) -> None:
    app = Shown()
    async with app.run_test(size=(80, 30)):
        await app.show(None, tmp_path)
        assert (app.figures, app.note) == ([], "nothing measured yet")


async def test_a_record_is_read_again_only_when_it_has_grown(
    measured: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read: list[Path] = []
    thread = asyncio.to_thread

    async def counted(function: object, path: Path) -> object:
        read.append(path)
        return await thread(function, path)  # type: ignore[arg-type]  # what the widget hands over

    monkeypatch.setattr(asyncio, "to_thread", counted)
    app = Shown()
    async with app.run_test(size=(80, 30)):
        for done in (1, 1, 2, 2):
            await app.show(run_of(measured, done), measured.parent)
    assert read == [measured, measured]


async def test_a_long_record_is_read_ever_less_often(measured: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[Path] = []

    async def counted(function: object, path: Path) -> tuple[()]:
        del function
        read.append(path)
        return ()

    monkeypatch.setattr(asyncio, "to_thread", counted)
    app = Shown()
    async with app.run_test(size=(80, 30)):
        for done in range(1, 1001):
            app.query_one(RecordFigures).show(run_of(measured, done), measured.parent)
            await asyncio.sleep(0)
        await app.workers.wait_for_complete()
    assert 100 < len(read) < 250


async def test_the_path_that_the_engine_named_is_read(measured: Path, tmp_path: Path) -> None:
    app, run = Shown(), run_of(measured)
    run.path = str(measured)
    async with app.run_test(size=(80, 30)):
        await app.show(run, tmp_path / "elsewhere")
        assert app.figures


async def test_a_record_that_cannot_be_read_says_why(tmp_path: Path) -> None:
    app = Shown()
    async with app.run_test(size=(80, 30)):
        await app.show(run_of(tmp_path / "none"), tmp_path)
        assert app.figures == []
        assert "none" in app.note


async def looked_at(
    app: Shown, pilot: Pilot[None], figures: tuple[Figure, ...], size: tuple[int, int]
) -> None:
    """Compare each figure, drawn alone, with its golden screen."""
    view = app.query_one(Figures)
    view.display = True
    for figure in figures:
        view.show(figure)
        assert not changed_screen(f"record-{figure.key}-{size[0]}x{size[1]}", await settled(app, pilot))


@pytest.mark.parametrize("size", SIZES)
async def test_places_arrows_and_differences_as_seen(tmp_path: Path, size: tuple[int, int]) -> None:
    runs = tmp_path / "runs"
    runs.mkdir()
    room = Room(runs)
    # An arm that is as it is drawn would show nothing but rounding.
    room.tracker.drift_mm = {number: 0.4 * (-1) ** number * number for number in range(4, 20)}
    measured = await validated(tmp_path, room)
    app = Shown()
    async with app.run_test(size=size) as pilot:
        await app.show(run_of(measured), measured.parent)
        await looked_at(app, pilot, app.query_one(FigureView).figures, size)


@pytest.mark.parametrize("size", SIZES)
async def test_errors_of_joints_and_ballbar_as_seen(size: tuple[int, int]) -> None:
    sections = axis_section(cast("RunReader", turned())), ballbar_section(cast("RunReader", Readings()))
    figures = tuple(block for one in sections for block in one.blocks if isinstance(block, Figure))
    app = Shown()
    async with app.run_test(size=size) as pilot:
        app.query_one("#record-note").display = False
        await looked_at(app, pilot, figures, size)
