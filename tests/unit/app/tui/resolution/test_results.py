"""The screen Results with a result of motion resolution: every part, the keys, the page's own figures."""

import os
from pathlib import Path

import pytest
from textual.widgets import ContentSwitcher

from catseye.app.results.figure_document import figures_json
from catseye.app.results.figures import Figure
from catseye.app.results.resolution.predicted import write_predicted
from catseye.app.results.resolution.result import write_resolution
from catseye.app.results.resolution.result_report import resolution_files_report
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.dialogs.text_dialog import TextDialog
from catseye.app.tui.resolution.result_view import SECTIONS, ResolutionView
from catseye.app.tui.widgets.figure_view import FigureView
from catseye.app.tui.widgets.static_text import StaticText
from tests.unit.app.results.resolution.sample import sample_prediction, sample_result
from tests.unit.app.tui.screens.test_results import look_again, open_app, press
from tests.unit.app.tui.scripted import changed_screen, work_of
from tests.unit.app.tui.stored_results import WRITTEN_S, write_results

SIZES = [(80, 24), (120, 40)]
NAMES = ("files", "verdict", "errors", "steps", "reversal", "cartesian", "recordings", "flags", "models")


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with a result of motion resolution, the newest."""
    path = tmp_path / "kuka.json"
    write_resolution(sample_result(), path)
    os.utime(path, (WRITTEN_S + 1e4, WRITTEN_S + 1e4))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("size", SIZES)
async def test_parts_as_they_are_seen(bench: Path, size: tuple[int, int]) -> None:
    app = open_app(bench)
    async with app.run_test(size=size) as pilot:
        await press(app, pilot, "enter")
        for number, name in enumerate(NAMES, 1):
            text = await press(app, pilot, str(number))
            assert not changed_screen(f"results-resolution-{name}-{size[0]}x{size[1]}", text)


async def test_the_screen_shows_the_figures_of_the_page(bench: Path) -> None:
    app = open_app(bench)
    seen: list[Figure] = []
    async with app.run_test(size=(120, 40)) as pilot:
        await press(app, pilot, "enter")
        for number in range(2, 2 + len(SECTIONS)):
            await press(app, pilot, str(number))
            section = app.screen.query_one("#resolution", ResolutionView)
            # A section without figures has those of the next one beside it, on wide screens.
            if not section.has_class("borrowed"):
                seen += section.query_one("#section-figures FigureView", FigureView).figures
    page = resolution_files_report([bench / "kuka.json"])
    paged = [block for block in page.blocks() if isinstance(block, Figure)]
    by_key = {figure.key: figure for figure in seen}
    assert len(by_key) == len(seen) == len(paged)
    assert figures_json(by_key[figure.key] for figure in paged) == figures_json(paged)


async def test_a_scaras_result_is_shown_after_one_of_resolution(bench: Path) -> None:
    write_results(bench)
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        text = await press(app, pilot, "enter")
        assert "kuka.json · " in text
        assert "3 Errors" in text
        text = await press(app, pilot, "1", "down", "enter")
        assert "error-map.json · " in text
        assert "3 Values" in text
        assert app.screen.query_one(ContentSwitcher).current == "maps"
        assert "3 Errors" in await press(app, pilot, "1", "up", "enter")


async def test_keys_of_a_scaras_result_do_nothing(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        await press(app, pilot, "enter", "d", "t", "b", "u", "e")
        assert work_of(app).done == []
        assert app.screen.query_one(ContentSwitcher).current == "resolution"


async def test_report_and_commands_of_a_result(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        await press(app, pilot, "enter", "p")
        page = bench / "kuka.html"
        assert work_of(app).done == [("report", str(bench / "kuka.json"), "-o", str(page))]
        text = await press(app, pilot, "colon")
        assert isinstance(app.screen, TextDialog)
        assert "catseye resolution-model" in text


async def test_a_result_that_is_written_anew_is_shown_anew(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        before = await press(app, pilot, "enter")
        fewer = sample_result()
        fewer.tests[:] = fewer.tests[:1]
        write_resolution(fewer, bench / "kuka.json")
        os.utime(bench / "kuka.json", (WRITTEN_S + 2e4, WRITTEN_S + 2e4))
        after = await look_again(app, pilot)
        assert "1 test" in after
        assert "1 test ·" not in before


async def test_what_was_predicted_beside_a_result_is_shown(bench: Path) -> None:
    write_predicted(sample_prediction(), bench / "predicted.json")
    other = sample_prediction().model_copy(update={"arm": "another-arm"})
    write_predicted(other, bench / "other.json")
    (bench / "broken.json").write_text("{", encoding="utf-8")
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        text = await press(app, pilot, "enter", "6")
        assert "predicted" in text
        await press(app, pilot, "p")
        sources = (str(bench / "kuka.json"), str(bench / "predicted.json"))
        assert work_of(app).done == [("report", *sources, "-o", str(bench / "kuka.html"))]


def rows_of(app: CatseyeApp, *names: str) -> list[str]:
    """Return which of these names begin a row of the section's tables, in their order."""
    text = app.screen.query_one("#said-text", StaticText).text.plain
    return [line.split()[0] for line in text.splitlines() if line.startswith(names)]


async def test_tables_of_a_section_are_filtered_and_sorted(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        await press(app, pilot, "enter", "4")
        every = rows_of(app, "A1 ", "A5 ")
        assert set(every) == {"A1", "A5"}
        text = await press(app, pilot, "slash", *"A5", "enter")
        assert set(rows_of(app, "A1 ", "A5 ")) == {"A5"}
        assert "/ A5" in text
        text = await press(app, pilot, "escape", "right", "s", "s")
        assert "›joint▼" in text
        assert rows_of(app, "A1 ", "A5 ")[0] == "A5"
        # Another section begins with all of its rows, as they come.
        await press(app, pilot, "5", "4")
        assert rows_of(app, "A1 ", "A5 ") == every
