"""Pictures of a run under way on a serial arm: what its record shows so far."""

import asyncio
from pathlib import Path

import pytest
from textual.app import App, ComposeResult

from catseye.app.tui.run_state import RunState, Step
from catseye.app.tui.serial.record_figures import RecordFigures
from catseye.app.tui.widgets.figure_view import FigureView
from catseye.app.tui.widgets.static_text import StaticText
from tests.unit.app.results.serial_arm.test_run_poses import validated


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

    async def show(self, run: RunState, root: Path) -> None:
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


async def test_a_run_that_begins_has_no_figures(measured: Path) -> None:
    app = Shown()
    async with app.run_test(size=(80, 30)):
        await app.show(run_of(measured), measured.parent)
        await app.show(run_of(measured.parent / "next", 0), measured.parent)
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
