"""Pictures of a run under way: what its record shows so far, on a serial arm."""

import asyncio
from pathlib import Path
from typing import cast

import pytest
from textual.app import App, ComposeResult
from textual.pilot import Pilot

from catseye.app.results.figures import Figure
from catseye.app.results.live_figures import LiveFigures
from catseye.app.results.serial_arm.axis_report import axis_section
from catseye.app.results.serial_arm.ballbar_report import ballbar_section
from catseye.app.store.reader import RunReader
from catseye.app.tui.pictures import Pictures, Wanted
from catseye.app.tui.run_state import RunState, Step
from catseye.app.tui.widgets.figure_view import Figures
from catseye.app.tui.widgets.record_figures import RecordFigures
from tests.unit.app.results.serial_arm.test_ballbar_report import Readings
from tests.unit.app.results.serial_arm.test_run_poses import validated
from tests.unit.app.results.serial_arm.test_run_report import turned
from tests.unit.app.tui.scripted import PaintedHere, changed_screen, settled
from tests.unit.procedures.serial_arm.benches import Room

SIZES = [(80, 24), (120, 40)]


class Shown(App[None]):
    """The widget alone."""

    def __init__(self) -> None:
        super().__init__()
        self.painter = PaintedHere()
        self.now_s = 0.0

    def compose(self) -> ComposeResult:
        yield RecordFigures(self.painter, lambda: self.now_s, id="record-figures")

    @property
    def pictures(self) -> Pictures:
        return self.query_one(RecordFigures).pictures

    async def show(self, run: RunState | None, root: Path) -> None:
        self.query_one(RecordFigures).show(run, root)
        await self.workers.wait_for_complete()


def said(figures: RecordFigures) -> str:
    return str(figures.border_subtitle)


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
        assert app.pictures.titles == ("Poses of the run", "Differences at poses", "Differences")
        assert app.pictures.note == ""


async def test_a_record_that_is_being_read_is_not_empty(measured: Path) -> None:
    app = Shown()
    async with app.run_test(size=(80, 30)):
        app.query_one(RecordFigures).show(run_of(measured), measured.parent)
        assert app.pictures.note == "reading the record …"
        await app.workers.wait_for_complete()
        assert (bool(app.pictures.titles), app.pictures.note) == (True, "")


async def test_a_run_that_begins_has_no_figures(measured: Path) -> None:
    app = Shown()
    async with app.run_test(size=(80, 30)):
        await app.show(run_of(measured), measured.parent)
        await app.show(run_of(measured.parent / "next", 0), measured.parent)
        assert (app.pictures.titles, app.pictures.note) == ((), "nothing measured yet")


async def test_before_the_first_run_there_are_no_figures(tmp_path: Path) -> None:
    app = Shown()
    async with app.run_test(size=(80, 30)):
        await app.show(None, tmp_path)
        assert (app.pictures.titles, app.pictures.note) == ((), "nothing measured yet")


async def test_a_record_is_read_again_only_when_it_has_grown(measured: Path) -> None:
    app = Shown()
    async with app.run_test(size=(80, 30)):
        for done in (1, 1, 2, 2):
            await app.show(run_of(measured, done), measured.parent)
    assert [wanted.look for wanted in app.painter.wanted] == [True, True]


async def test_looks_take_a_fifth_of_the_time_at_most(measured: Path) -> None:
    app = Shown()

    async def slow(wanted: Wanted) -> Pictures:
        app.painter.wanted.append(wanted)
        app.now_s += 2.0
        return Pictures(("one",), lines=([("drawn", "")],), shown=1)

    async with app.run_test(size=(80, 30)):
        app.painter.draw = slow  # type: ignore[method-assign]  # takes two seconds by the test's clock
        for done in range(1, 101):
            app.now_s += 0.5
            await app.show(run_of(measured, done), measured.parent)
    # After the first look, which reads all that there is, two seconds go by: four steps. After the others it is
    # eight seconds: sixteen steps.
    assert len(app.painter.wanted) == 2 + (99 - 4) // 16


async def test_missing_pictures_are_tried_again_without_a_further_step(measured: Path) -> None:
    app = Shown()
    answers = [Pictures(note="the pictures are missing", failed=True), Pictures(("one",), shown=1)]

    async def fails_once(wanted: Wanted) -> Pictures:
        app.painter.wanted.append(wanted)
        return answers.pop(0)

    async with app.run_test(size=(80, 30)):
        app.painter.draw = fails_once  # type: ignore[method-assign]  # as if its process had died
        await app.show(run_of(measured), measured.parent)
        app.now_s += 4.9
        await app.show(run_of(measured), measured.parent)
        assert app.pictures.note == "the pictures are missing"
        app.now_s += 0.1
        await app.show(run_of(measured), measured.parent)
        assert (app.pictures.titles, app.pictures.note) == (("one",), "")


async def test_a_picture_that_is_late_says_so(measured: Path) -> None:
    app = Shown()
    drawn: asyncio.Future[Pictures] = asyncio.get_running_loop().create_future()

    async def late(wanted: Wanted) -> Pictures:
        app.painter.wanted.append(wanted)
        return await drawn

    async with app.run_test(size=(80, 30)) as pilot:
        app.painter.draw = late  # type: ignore[method-assign]  # answers when the test says so
        figures = app.query_one(RecordFigures)
        app.now_s = 2600.0
        for _ in range(2):
            figures.show(run_of(measured), measured.parent)
            assert said(figures) == ""
        await pilot.pause()
        app.now_s += 12.0
        figures.show(run_of(measured), measured.parent)
        assert said(figures) == "being drawn anew for 12 s"
        drawn.set_result(Pictures(("one",), shown=1))
        await app.workers.wait_for_complete()
        assert said(figures) == ""


async def test_a_new_run_waits_for_no_picture_of_the_last(measured: Path) -> None:
    """Drawing the last one took 20 s; the new one is drawn at its first step."""
    app = Shown()
    drawn: asyncio.Future[Pictures] = asyncio.get_running_loop().create_future()

    async def late(wanted: Wanted) -> Pictures:
        app.painter.wanted.append(wanted)
        return await drawn

    async with app.run_test(size=(80, 30)) as pilot:
        app.painter.draw = late  # type: ignore[method-assign]  # answers when the test says so
        figures = app.query_one(RecordFigures)
        figures.show(run_of(measured), measured.parent)
        await pilot.pause()
        app.now_s += 20.0
        figures.show(run_of(measured.parent / "next", 0), measured.parent)
        drawn.set_result(Pictures(("one",), shown=1))
        await app.workers.wait_for_complete()
        assert (app.pictures.note, said(figures)) == ("nothing measured yet", "")
        await app.show(run_of(measured.parent / "next"), measured.parent)
        assert app.painter.wanted[-1].path.name == "next"


async def test_turning_draws_the_next_picture_without_a_look(measured: Path) -> None:
    app = Shown()
    async with app.run_test(size=(58, 30)):
        await app.show(run_of(measured), measured.parent)
        figures = app.query_one(RecordFigures)
        assert figures.border_subtitle == "1 of 3, v: next"
        for place in (1, 2, 0):
            figures.turn()
            await app.workers.wait_for_complete()
            assert app.pictures.first == place
        assert [wanted.look for wanted in app.painter.wanted] == [True, False, False, False]


async def test_the_path_that_the_engine_named_is_read(measured: Path, tmp_path: Path) -> None:
    app, run = Shown(), run_of(measured)
    run.path = str(measured)
    async with app.run_test(size=(80, 30)):
        await app.show(run, tmp_path / "elsewhere")
        assert app.pictures.titles


async def test_a_record_that_cannot_be_read_says_why(tmp_path: Path) -> None:
    app = Shown()
    async with app.run_test(size=(80, 30)):
        await app.show(run_of(tmp_path / "none"), tmp_path)
        assert app.pictures.titles == ()
        assert "none" in app.pictures.note


class Waiting:
    """Implements `Painter`: draws a run when it is let go."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.given_up: list[str] = []
        self.let_go = asyncio.Event()

    async def draw(self, wanted: Wanted) -> Pictures:
        name = wanted.path.name
        self.asked.append(name)
        try:
            await self.let_go.wait()
        except asyncio.CancelledError:
            self.given_up.append(name)
            raise
        return Pictures((name,), lines=([(name, "")],), shown=1)

    async def close(self) -> None:
        """Leave nothing behind: there is nothing."""


class Slow(App[None]):
    def __init__(self) -> None:
        super().__init__()
        self.painter = Waiting()

    def compose(self) -> ComposeResult:
        yield RecordFigures(self.painter, lambda: 0.0, id="record-figures")


async def test_pictures_of_the_run_before_are_never_shown(tmp_path: Path) -> None:
    app = Slow()
    async with app.run_test(size=(80, 30)) as pilot:
        figures = app.query_one(RecordFigures)
        for name in ("before", "after"):
            figures.show(run_of(tmp_path / name), tmp_path)
            await pilot.pause()
        assert app.painter.asked == ["before"]
        app.painter.let_go.set()
        await app.workers.wait_for_complete()
        await pilot.pause()
        await app.workers.wait_for_complete()
        assert app.painter.asked == ["before", "after"]
        assert figures.pictures.titles == ("after",)


async def test_a_closed_screen_gives_its_picture_up(tmp_path: Path) -> None:
    app = Slow()
    async with app.run_test(size=(80, 30)) as pilot:
        app.query_one(RecordFigures).show(run_of(tmp_path / "slow"), tmp_path)
        await pilot.pause()
        await app.query_one(RecordFigures).remove()
        await pilot.pause()
        assert app.painter.given_up == ["slow"]


class Drawn(App[None]):
    """Figures alone."""

    def compose(self) -> ComposeResult:
        yield Figures()


async def looked_at(
    app: Drawn, pilot: Pilot[None], figures: tuple[Figure, ...], size: tuple[int, int]
) -> None:
    """Compare each figure, drawn alone, with its golden screen."""
    view = app.query_one(Figures)
    assert figures
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
    app = Drawn()
    async with app.run_test(size=size) as pilot:
        await looked_at(app, pilot, LiveFigures(measured).look(), size)


@pytest.mark.parametrize("size", SIZES)
async def test_errors_of_joints_and_ballbar_as_seen(size: tuple[int, int]) -> None:
    sections = axis_section(cast("RunReader", turned())), ballbar_section(cast("RunReader", Readings()))
    figures = tuple(block for one in sections for block in one.blocks if isinstance(block, Figure))
    app = Drawn()
    async with app.run_test(size=size) as pilot:
        await looked_at(app, pilot, figures, size)
