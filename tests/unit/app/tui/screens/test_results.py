"""The screen Results: every part, every key, its numbers against the result file."""

import json
import os
import re
from pathlib import Path
from threading import Event
from typing import Any

import pytest
from textual.pilot import Pilot
from textual.widgets import ContentSwitcher, DataTable, Input

from catseye.app.results.figure_document import figures_json
from catseye.app.results.figures import Figure
from catseye.app.results.result_files import ResultFile, ResultFiles
from catseye.app.results.scara.run_report import result_file_report
from catseye.app.results.scara.validation_document import DistanceValidationDocument
from catseye.app.service.command_process import Done
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from catseye.app.tui.dialogs.form_dialog import FormDialog
from catseye.app.tui.dialogs.text_dialog import TextDialog
from catseye.app.tui.result_shelf import as_scaras
from catseye.app.tui.screens.results import ResultsScreen
from catseye.app.tui.widgets import preview
from catseye.app.tui.widgets.figure_view import FigureView
from catseye.app.tui.widgets.row_table import RowTable
from catseye.app.tui.widgets.static_text import StaticText
from tests.unit.app.tui.screens.test_runs import settle
from tests.unit.app.tui.scripted import ScriptedLink, changed_screen, failed, make_app, shown, work_of
from tests.unit.app.tui.stored_results import (
    DIAGNOSIS,
    RUN,
    WRITTEN_S,
    error_map,
    validation,
    write_results,
)


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with results and the run that they come from."""
    write_results(tmp_path)
    (tmp_path / "runs" / RUN).mkdir(parents=True)
    (tmp_path / "runs" / "20261119T090000Z_validation-path_bbbbbb").mkdir()
    (tmp_path / "runs" / "20261119T093000Z_validation-path_cccccc").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(preview, "RESTS_S", 1e-3)
    return tmp_path


def open_app(bench: Path) -> CatseyeApp:
    app = make_app(ScriptedLink(), "results", root=bench / "runs")
    work = work_of(app)
    work.outcomes["diagnose"] = Done((), 0, DIAGNOSIS.model_dump_json(), "")
    work.outcomes["validate"] = Done((), 0, validation().model_dump_json(), "")
    return app


async def press(app: CatseyeApp, pilot: Pilot[Any], *keys: str) -> str:
    """Press keys, each after everything that the one before has begun; return the screen."""
    for key in keys:
        await settle(app, pilot)
        await pilot.press(key)
    await settle(app, pilot)
    return await shown(app, pilot)


WAY_THROUGH_THE_PARTS = (
    ("files", ()),
    ("maps", ("enter",)),
    ("values", ("3",)),
    ("layout", ("4",)),
    ("residuals", ("d", "5")),
    ("fit", ("6",)),
    ("path", ("t", "enter")),
    ("compare", ("1", "down", "b")),
    ("compare-in-u", ("u",)),
)


@pytest.mark.parametrize("size", [(80, 24), (120, 40), (200, 60)])
async def test_parts_as_they_are_seen(bench: Path, size: tuple[int, int]) -> None:
    """One program shows all of them, one after the other: its start takes longer than a part."""
    app = open_app(bench)
    async with app.run_test(size=size) as pilot:
        for name, keys in WAY_THROUGH_THE_PARTS:
            assert not changed_screen(f"results-{name}-{size[0]}x{size[1]}", await press(app, pilot, *keys))


async def test_screen_and_page_show_figures_of_the_same_data(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        await press(app, pilot, "enter", "d", "t", "enter", "1", "down", "b")
        shown_now = [figure for view in app.screen.query(FigureView) for figure in view.figures]
    page = result_file_report(bench / "error-map.json")
    paged = [block for block in page.blocks() if isinstance(block, Figure)]
    assert {figure.key for figure in paged} == {
        "maps",
        "residual-order",
        "residuals",
        "residual-poses",
        "layout",
    }
    by_key = {figure.key: figure for figure in shown_now}
    assert figures_json(by_key[figure.key] for figure in paged) == figures_json(paged)
    assert figures_json([by_key["diagnosis-order"]]) == figures_json(DIAGNOSIS.figures)
    assert figures_json([by_key["path"]]) == figures_json(validation().figures)
    assert "differences" in by_key


async def test_files_newest_first_and_what_is_none_at_the_end(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        await press(app, pilot)
        table = app.screen.query_one("#file-table", DataTable)
        names = [Path(str(key.value)).name for key in table.rows]
        assert names == ["error-map.json", "later.json", "conventional.json", "broken.json"]
        text = await press(app, pilot, "down", "down", "down", "enter")
        assert isinstance(app.screen, ErrorDialog)
        assert "broken.json cannot be read" in text
        # The cursor stays on its result when a newer one comes.
        await press(app, pilot, "escape", "up", "up")
        write_anew(bench / "newest.json", error_map(), 900)
        await look_again(app, pilot)
        assert "later.json · " in await press(app, pilot, "enter")


async def test_files_and_values_are_filtered_and_sorted(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        await press(app, pilot)
        files = app.screen.query_one("#file-table", RowTable)
        every = files.row_count
        await press(app, pilot, "slash", *"conv")
        assert files.row_count < every
        assert "conv" in files.chosen
        await press(app, pilot, "escape")
        assert files.row_count == every
        await press(app, pilot, "home", "enter", "3", "slash", *"l1")
        values = app.screen.query_one("#value-table", RowTable)
        assert [values.get_row_at(place)[0].plain for place in range(values.row_count)] == ["L1"]
        text = await press(app, pilot, "escape", "right", "s")
        assert "value▲" in text
        cells = [values.get_row_at(place)[1].plain for place in range(values.row_count)]
        numbers = [float(cell.replace("−", "-")) for cell in cells]
        assert len(numbers) > 3
        assert numbers == sorted(numbers)


async def test_values_are_those_of_the_file(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(120, 60)) as pilot:
        await press(app, pilot, "enter", "3")
        table = app.screen.query_one("#value-table", DataTable)
        rows = {
            str(cells[0]): [str(cell).strip() for cell in cells[1:]]
            for cells in map(table.get_row, table.rows)
        }
    assert rows["L1"] == ["325.0123", "0.0080", "mm"]
    stored = error_map()
    for joint in (1, 2):
        part = stored[f"theta{joint}_map"]
        for sign, direction in (("+", "positive"), ("−", "negative")):
            for place, node in enumerate(part["node_deg"]):
                value, u = part[f"{direction}_mdeg"][place], part[f"u_{direction}_mdeg"][place]
                expected = [f"{value:.2f}".replace("-", "−"), f"{2 * u:.2f}", "mdeg"]
                assert rows[f"Δθ{joint}({node:g}°, {sign})"] == expected
    assert rows["P1.x"] == ["650.1250", "0.0400", "mm"]
    assert rows["dead path P1/0"] == ["512.3456", "0.0500", "mm"]
    # Two links, six nodes of each joint, two coordinates of two reflectors, two dead paths.
    assert len(rows) == 2 + 6 + 6 + 4 + 2


async def test_comparison_in_mdeg_and_in_combined_uncertainties(bench: Path) -> None:
    """L1 changed by 20 µm with u = 5 µm, one node by 5 mdeg with u = √2 · 2.5 mdeg."""
    far = error_map()
    far["theta1_map"] = {**far["theta1_map"], "node_deg": [200.0, 220.0, 240.0]}
    write_anew(bench / "far.json", far, -60)
    app = open_app(bench)
    async with app.run_test(size=(120, 60)) as pilot:
        await press(app, pilot, "enter", "b")
        assert app.screen.query_one(ContentSwitcher).current == "files", "compared with itself"
        text = await press(app, pilot, "1", "down", "b")
        assert app.screen.query_one(ContentSwitcher).current == "compare"
        assert "later.json (second) minus error-map.json (first)" in text
        squeezed = " ".join(text.split())
        assert "L1 mm 325.0123 325.0323 +0.0200 0.0100 +4.00" in squeezed
        assert re.search(r"Δθ2\(60°, \+\) mdeg \S+ \S+ \+5\.00 7\.07 \+1\.41", squeezed)
        assert re.search(r"Δθ2\(60°, −\) mdeg \S+ \S+ 0\.00 3\.54 0\.00", squeezed)
        assert "Δθ2 difference / mdeg" in text
        assert "Δθ2 difference / u" in await press(app, pilot, "u")
        # Two results that cannot be compared do not borrow the figures of others.
        await press(app, pilot, "1", "down", "down", "b")
        assert isinstance(app.screen, ErrorDialog)
        text = await press(app, pilot, "escape", "8", "u")
        assert "later.json (second) minus error-map.json (first)" in text
        assert "far.json" not in text


async def test_a_comparison_is_filtered_and_sorted(bench: Path) -> None:
    app = open_app(bench)

    def links() -> list[str]:
        text = app.screen.query_one("#comparison", StaticText).text.plain
        return [line.split()[0] for line in text.splitlines() if line.startswith(("L1 ", "L2 "))]

    async with app.run_test(size=(120, 60)) as pilot:
        await press(app, pilot, "enter", "1", "down", "b")
        assert links() == ["L1", "L2"]
        assert "/ L2" in await press(app, pilot, "slash", *"L2", "enter")
        assert links() == ["L2"]
        await press(app, pilot, "escape")
        assert links() == ["L1", "L2"]
        assert "›quantity▼" in await press(app, pilot, "s", "s")
        assert links() == ["L2", "L1"]
        await press(app, pilot, "s")
        assert links() == ["L1", "L2"]


async def test_an_outdated_comparison_disappears(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(120, 60)) as pilot:
        await press(app, pilot, "enter")
        shown_before = "+0.0200"
        for age_s, name, link1_mm in ((900, "error-map.json", 325.5), (1800, "later.json", 326.0)):
            assert shown_before in await press(app, pilot, "1", "down", "b"), name
            write_anew(bench / name, {**error_map(), "link1_mm": {"value": link1_mm, "u": 0.004}}, age_s)
            text = await look_again(app, pilot)
            assert shown_before not in text, name
            assert "put the cursor on another result (1), then b" in text, name
            await press(app, pilot, "1", "up")
            shown_before = "-0.4677"


def write_anew(path: Path, content: dict[str, Any], age_s: int) -> None:
    path.write_text(json.dumps(content), encoding="utf-8")
    os.utime(path, (WRITTEN_S + age_s, WRITTEN_S + age_s))


async def look_again(app: CatseyeApp, pilot: Pilot[Any]) -> str:
    assert isinstance(app.screen, ResultsScreen)
    app.screen.on_screen_resume()
    return await press(app, pilot)


async def test_a_late_validation_does_not_replace_another_results_screen(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(120, 40), notifications=True) as pilot:
        await press(app, pilot, "enter", "t", "enter")
        screen = app.screen
        assert isinstance(screen, ResultsScreen)
        late = as_scaras(screen._files[1])  # noqa: SLF001  # what a command under way is given
        assert late is not None
        await press(app, pilot, "3")
        screen._validated(late, Done((), 0, validation().model_dump_json(), ""))  # noqa: SLF001  # as its end
        assert screen.query_one(ContentSwitcher).current == "values"
        assert "later.json: choose it, then 7" in await press(app, pilot)


async def test_conventional_model_has_no_map_and_says_so(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(80, 24)) as pilot:
        text = await press(app, pilot, "down", "down", "enter", "2")
        assert "no map: θ20 = 4.00 mdeg, U = 1.00" in text
        # Every key stands in the palette.
        screen = app.screen
        assert isinstance(screen, ResultsScreen)
        titles = [command.title for command in screen.commands()]
        names = [binding.id for binding in screen.BINDINGS if not isinstance(binding, tuple)]
        assert len(names) == len(set(names))
        actions = {binding.action for binding in screen.BINDINGS if not isinstance(binding, tuple)}
        # All parts, and one command for each other action; back is cancelling and the first part.
        assert len(titles) == len(set(titles)) == len(actions - {"back"}) + 1


async def test_a_changed_result_drops_its_diagnosis(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        text = await press(app, pilot, "enter", "5")
        assert "THE FILE IS GONE" not in text
        assert "d: diagnosis" in text
        assert "left out: row 12" in text
        text = await press(app, pilot, "d")
        assert work_of(app).done == [("diagnose", RUN, "--runs", str(bench / "runs"), "--json")]
        assert "1     +60.0 µm   +9.4  row 7 (reflector P1, θ1 -28°)" in text
        assert "2     -45.0 µm   -6.1  row 31 (reflector P2, θ1 20°)" in text
        text = await press(app, pilot, "6")
        assert "✓ The error map leaves 12.3 µm" in text
        assert "✗ 2 distances stand out" in text
        write_anew(bench / "error-map.json", {**error_map(), "link1_mm": {"value": 325.5, "u": 0.004}}, 900)
        text = await look_again(app, pilot)
        assert "L1 = 325.5000 mm" in text
        assert "d: diagnosis" in text
        (bench / "error-map.json").unlink()
        assert "THE FILE IS GONE" in await look_again(app, pilot)


async def test_a_diagnosis_stands_on_the_budget_of_its_result(bench: Path) -> None:
    budget = {"format": "catseye-budget/1", "source": "none", "name": RUN, "contributor": []}
    write_anew(bench / "error-map.json", {**error_map(), "budget": budget}, 900)
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        assert "No error budget was used" in await press(app, pilot, "enter", "6")
        await press(app, pilot, "d")
        runs = str(bench / "runs")
        assert work_of(app).done == [("diagnose", RUN, "--runs", runs, "--budget", "none", "--json")]


async def test_missing_inputs_of_a_diagnosis_or_validation_are_shown(bench: Path) -> None:
    app = open_app(bench)
    work_of(app).outcomes["validate"] = failed(2, "it holds nothing to export: look at its timeline")
    async with app.run_test(size=(80, 24)) as pilot:
        text = await press(app, pilot, "enter", "t", "enter")
        assert isinstance(app.screen, ErrorDialog)
        assert "→ look at its timeline" in text
        assert [words[0] for words in work_of(app).done] == ["validate"]
        work_of(app).done.clear()
        (bench / "runs" / RUN).rmdir()
        text = await press(app, pilot, "escape", "d")
        assert isinstance(app.screen, ErrorDialog)
        assert "→ put the runs there" in text
        assert work_of(app).done == []


async def test_validation_uses_the_newest_path_and_matching_conventional_model(
    bench: Path,
) -> None:
    app = open_app(bench)
    async with app.run_test(size=(80, 24)) as pilot:
        await press(app, pilot, "enter", "t")
        assert isinstance(app.screen, FormDialog)
        text = await press(app, pilot, "enter")
        assert work_of(app).done == [
            (
                *("validate", str(bench / "error-map.json")),
                *("--measured", "20261119T093000Z_validation-path_cccccc", "--runs", str(bench / "runs")),
                *("--reference", str(bench / "conventional.json"), "--json"),
            )
        ]
        assert "31 of 33 rows compared" in text
        assert "ratio 0.080" in text


async def test_validation_on_distances_is_said_in_words(bench: Path) -> None:
    app = open_app(bench)
    document = DistanceValidationDocument(
        rows=9, compared=9, left_out=[], models=[], ratio=None, limit_um=None, within_limit=None
    )
    talk = "✓ On distances along a path the error map leaves 9.1 µm rms"
    work_of(app).outcomes["validate"] = Done((), 0, document.model_dump_json(), talk)
    async with app.run_test(size=(80, 24)) as pilot:
        text = await press(app, pilot, "enter", "t", "enter")
        assert isinstance(app.screen, TextDialog)
        assert "the error map leaves 9.1 µm rms" in text


async def test_validation_on_a_measured_file(bench: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(bench))
    (bench / "tracker.csv").write_text("", encoding="utf-8")
    app = open_app(bench)
    result = str(bench / "error-map.json")

    async def validate(pilot: Pilot[Any], measured: str, reference: str) -> str:
        work_of(app).done.clear()
        app.screen.query_one("#measured", Input).value = measured
        app.screen.query_one("#reference", Input).value = reference
        return await press(app, pilot, "enter")

    async with app.run_test(size=(80, 24)) as pilot:
        await press(app, pilot, "enter", "t")
        assert "there is no file nowhere.json" in await validate(pilot, "tracker.csv", "nowhere.json")
        assert work_of(app).done == []
        await validate(pilot, "tracker.csv", "")
        runs = ("--runs", str(bench / "runs"))
        assert work_of(app).done == [("validate", result, "--measured", "tracker.csv", *runs, "--json")]
        # A home folder is meant by its sign.
        await press(app, pilot, "t")
        await validate(pilot, "~/tracker.csv", "~/conventional.json")
        files = (
            *("--measured", str(bench / "tracker.csv"), *runs),
            *("--reference", str(bench / "conventional.json")),
        )
        assert work_of(app).done == [("validate", result, *files, "--json")]
        # A path of an impossible name is taken for a run.
        await press(app, pilot, "t")
        await validate(pilot, "~nobody-of-this-name/" + "x" * 300, "")
        assert work_of(app).done[0][3] == "~nobody-of-this-name/" + "x" * 300


CANNOT_BE_WRITTEN = (
    ("~nobody-of-this-name/x.csv", "there is no folder ~nobody-of-this-name"),
    ("x" * 300 + ".csv", "File name too long"),
    ("nowhere/x.csv", "there is no folder nowhere: make it first"),
    ("later.json", "is there already"),
)


async def test_report_export_and_commands_to_type(bench: Path) -> None:
    app = open_app(bench)
    result = bench / "error-map.json"
    async with app.run_test(size=(120, 40)) as pilot:
        await press(app, pilot, "enter", "e")
        for typed, fault in CANNOT_BE_WRITTEN:
            app.screen.query_one("#file", Input).value = typed
            assert fault in await press(app, pilot, "enter"), typed
            assert isinstance(app.screen, FormDialog), typed
            assert work_of(app).done == [], typed
        await press(app, pilot, "escape", "p")
        await press(app, pilot, "e", "enter")
        assert work_of(app).done == [
            ("report", str(result), "-o", str(bench / "error-map.html")),
            ("export", str(result), "-o", str(bench / "error-map.csv")),
        ]
        text = await press(app, pilot, "colon")
        assert isinstance(app.screen, TextDialog)
        squeezed = " ".join(text.replace("┃", " ").split())
        assert "catseye predict" in squeezed
        assert "catseye compensate" in squeezed


async def test_nothing_to_show_yet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    app = make_app(ScriptedLink(), "results", root=tmp_path / "runs")
    async with app.run_test(size=(80, 24)) as pilot:
        text = await press(app, pilot, *"12345678", *"dtcupoey", "escape", "enter")
        assert isinstance(app.screen, ResultsScreen)
        assert "0 results; none yet: identify on Runs (F7), i" in text


async def test_no_count_before_the_files_were_read(bench: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read, look = Event(), ResultFiles.look

    def slow_look(files: ResultFiles[Any]) -> list[ResultFile[Any]]:
        read.wait(10.0)
        return look(files)

    monkeypatch.setattr(ResultFiles, "look", slow_look)
    app = open_app(bench)
    async with app.run_test(size=(80, 24)) as pilot:
        before = await shown(app, pilot)
        read.set()
        after = await press(app, pilot)
    assert "reading the result files …" in before
    assert "none yet" not in before
    assert "4 results; Enter shows one" in after


async def test_any_size(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(30, 8)) as pilot:
        await press(app, pilot, "enter", "d", "1", "down", "b")
        for size in ((30, 8), (60, 20), (100, 30), (200, 60)):
            await pilot.resize_terminal(*size)
            await press(app, pilot, *"12345678")
            assert app.is_running, size
