"""The card at the end of a run: what it came to, what was warned of, what was written, a key for each."""

import json
import os
from pathlib import Path
from typing import Any, Final

import pytest
from textual.content import Content

from catseye.app.results.readiness import run_files
from catseye.app.results.scara.result import write_result
from catseye.app.service.command_process import Done
from catseye.app.tui.dialogs.form_dialog import FormDialog
from catseye.app.tui.dialogs.text_dialog import TextDialog
from catseye.app.tui.screens import ended_run, working
from catseye.app.tui.widgets.status_bar import StatusBar
from tests.unit.app.results.scara import sample
from tests.unit.app.tui.screens.run_screen import run_screen, settled
from tests.unit.app.tui.scripted import ScriptedLink, changed_screen, make_app, shown, work_of
from tests.unit.app.tui.scripted_run import RUN, SNAPSHOT, end, publish

SIZES = [(80, 24), (120, 40)]

PITCH: Final = {
    "sign": "good",
    "text": "Pitch of the beam: +0.930 mrad before, +0.080 ± 0.040 mrad (k = 2) after 3 turns of the screw; the "
    "tolerance is 0.2 mrad.",
    "short": "+0.08 of ±0.2 mrad",
}
LEAST: Final = {"sign": "neutral", "text": "A1+ at K1: least step 0.9 mdeg (0.8 … 1.1 mdeg)", "short": ""}
WARM: Final = {
    "sign": "bad",
    "text": "Not warm: after 41 min 31.0 ± 4.0 µm in 10 min, the limit is 20 µm in 10 min.",
    "short": "not warm after 41 min",
}
LEFT: Final = {
    "sign": "good",
    "text": "On distances along a path the error map leaves 10.9 µm rms, the conventional model 92.0 µm: ratio 0.12 "
    "(80 of 101 rows compared).",
    "short": "conventional model 92.0 µm → error map 10.9 µm",
}


def says(*said: dict[str, str]) -> Done:
    """Return the end of a command that writes sentences among other things."""
    return Done((), 0, json.dumps({"run": RUN, "counts": {}, "said": said}), "")


def ended(link: ScriptedLink, warnings: int = 0) -> None:
    """Have a run end that measured nothing and warned so often."""
    publish(link, "step-done", step="a", title="the last step", stored=False)
    for number in range(warnings):
        publish(link, "warning", text=f"the air moved by {number + 1} K in a minute")
    end(link, "complete")


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize(
    ("name", "procedure", "said"),
    [
        ("scara", "beam-level", [PITCH]),
        ("resolution", "resolution", [LEAST] * 6),
        ("six-axis", "tracker-warmup", [WARM]),
    ],
)
async def test_the_card_shows_what_a_run_came_to(
    size: tuple[int, int], name: str, procedure: str, said: list[dict[str, str]]
) -> None:
    async with run_screen({**SNAPSHOT, "procedure": procedure, "title": procedure}, size=size) as opened:
        app, pilot, link = opened
        work_of(app).outcomes["show"] = says(*said)
        ended(link, warnings=3)
        text = await settled(app, pilot, link)
        while "reading the record" in text:
            # A thread looks for the record, which a test has none of.
            text = await settled(app, pilot, link)
        assert work_of(app).done == [("show", RUN, "--runs", "/bench/catseye-runs", "--json")]
        assert not changed_screen(f"run-ended-{name}-{size[0]}x{size[1]}", text)


async def test_a_rejected_run_offers_no_resume() -> None:
    async with run_screen() as (app, pilot, link):
        work_of(app).outcomes["show"] = says()
        end(link, "failed", "the counter's sign is reversed", rejected=True)
        text = await settled(app, pilot, link)
        assert "FAILED" in text
        assert "p  report" in text
        assert "resume" not in text
        await pilot.press("r", "f8")
        await settled(app, pilot, link)
        assert "resume" not in link.ops


@pytest.mark.parametrize("size", SIZES)
async def test_a_path_shows_what_was_left_before_and_after(size: tuple[int, int], tmp_path: Path) -> None:
    link = ScriptedLink({**SNAPSHOT, "procedure": "validation-path", "title": "Validation path"})
    result, root = tmp_path / "map.json", tmp_path / "runs"
    made = sample.hand_made()
    earlier = {"runs": ["20261101T090000Z_open-loop_00beef"]}
    write_result(made.model_copy(update={"provenance": made.provenance.model_copy(update=earlier)}), result)
    app = make_app(link, "run", root=root)
    work_of(app).outcomes.update(show=says(), validate=says(LEFT))
    async with app.run_test(size=size) as pilot:
        ended(link)
        text = await settled(app, pilot, link)
        words = ("validate", str(result), "--measured", RUN, "--runs", str(root))
        assert work_of(app).done[-1] == (*words, "--json")
        assert not changed_screen(f"run-ended-path-{size[0]}x{size[1]}", text)
        await pilot.press("t")
        page = tmp_path / "validation-abc123.html"
        # The command has to begin before anybody can wait for its end.
        await settled(app, pilot, link)
        text = await settled(app, pilot, link)
        assert work_of(app).done[-1] == (*words, "-o", str(page))
        assert "o opens it" in text


async def test_what_the_card_cannot_find_out_is_left_away() -> None:
    async with run_screen() as (app, pilot, link):
        work_of(app).outcomes["show"] = Done((), 3, "", "it broke")
        ended(link)
        text = await settled(app, pilot, link)
        assert "COMPLETE" in text
        assert "evaluating" not in text
        assert "Oops" not in text


async def test_warnings_are_counted_and_the_last_are_shown() -> None:
    async with run_screen(size=(120, 40)) as (app, pilot, link):
        ended(link, warnings=5)
        card = (await settled(app, pilot, link)).partition("The run has ended")[2].partition("Log")[0]
        assert "! 5 warnings, the last: the air moved by 4 K in a minute" in card
        assert "the air moved by 5 K" in card
        assert "the air moved by 3 K" not in card


async def test_a_written_page_is_opened_by_its_key(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []

    async def note(uri: str) -> str:
        opened.append(uri)
        return ""

    monkeypatch.setattr(working, "can_open", lambda: True)
    monkeypatch.setattr(working, "open_page", note)
    link = ScriptedLink(SNAPSHOT)
    app = make_app(link, "run", root=tmp_path / "runs")
    async with app.run_test(size=(120, 40)) as pilot:
        ended(link)
        await settled(app, pilot, link)
        await pilot.press("p")
        await settled(app, pilot, link)
        await pilot.press("o")
        await settled(app, pilot, link)
        assert opened == [(tmp_path / "report-abc123.html").as_uri()]


async def test_an_identified_result_states_what_it_is_worth(tmp_path: Path) -> None:
    link = ScriptedLink(SNAPSHOT)
    app = make_app(link, "run", root=tmp_path / "runs")
    made = sample.hand_made()
    write_result(made, tmp_path / "result-abc123-2.json")
    # The command of a test writes nothing: what it would write lies there under the name that is free.
    (tmp_path / "result-abc123.json").write_text("somebody's")
    monkeyed: dict[str, Any] = {"free": tmp_path / "result-abc123-2.json"}
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(ended_run, "free_name", lambda _path: monkeyed["free"])
        async with app.run_test(size=(120, 40)) as pilot:
            ended(link)
            await settled(app, pilot, link)
            await pilot.press("i")
            text = await settled(app, pilot, link)
    assert "✓ identify: maps U ≤ " in text
    assert "F6 shows it" in text
    assert app.session.wanted == tmp_path / "result-abc123-2.json"


async def test_the_card_of_another_run_begins_empty() -> None:
    async with run_screen() as (app, pilot, link):
        work_of(app).outcomes["show"] = says(PITCH)
        ended(link)
        assert "Pitch" in await settled(app, pilot, link)
        link.publish(
            "run-started", procedure="open-loop", title="Open loop", run="20261121T110000Z_open-loop_00beef"
        )
        await settled(app, pilot, link)
        work_of(app).outcomes["show"] = says()
        link.publish(
            "run-ended",
            run="20261121T110000Z_open-loop_00beef",
            status="failed",
            exit_code=3,
            text="no link",
            path="",
            drives_on=False,
        )
        text = await shown(app, pilot)
        assert "FAILED" in text
        assert "Pitch" not in text


@pytest.mark.parametrize("size", SIZES)
async def test_an_abort_is_one_red_line_with_its_remedy(size: tuple[int, int]) -> None:
    async with run_screen(size=size) as (app, pilot, link):
        publish(link, "state", state="ABORTING", reason="emergency stop")
        assert (await shown(app, pilot)).startswith(
            " Keep clear until the arm is at rest.  ABORTING: emergency stop"
        )
        publish(link, "state", state="ABORTED", reason="emergency stop")
        end(link, "aborted", "emergency stop pressed")
        text = await settled(app, pilot, link)
        first = " Look at the bench, then F4 and x.  ABORTED: emergency stop pressed"
        assert text.startswith(first)
        bar = app.screen.query_one(StatusBar).render()
        assert isinstance(bar, Content)
        assert {str(span.style) for span in bar.spans if span.start < len(first)} == {"bold white on darkred"}
        assert not changed_screen(f"run-aborted-{size[0]}x{size[1]}", text)


async def test_files_that_others_wrote_stand_on_the_card(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root, made = tmp_path / "runs", sample.hand_made()
    root.mkdir()
    monkeypatch.setattr(run_files, "cell_of_run", lambda _run: "lab-1")
    for name, run in (("map.json", RUN), ("older.json", "20261101T090000Z_open-loop_00beef")):
        of_run = made.provenance.model_copy(update={"runs": [run]})
        write_result(made.model_copy(update={"provenance": of_run}), tmp_path / name)
    os.utime(tmp_path / "older.json", (1e9, 1e9))
    (tmp_path / "mine.html").write_text(f"<title>open-loop on lab-1</title>{RUN}", encoding="utf-8")
    app = make_app(link := ScriptedLink(SNAPSHOT), "run", root=root)
    async with app.run_test(size=(120, 40)) as pilot:
        ended(link)
        text = await settled(app, pilot, link)
        assert "mine.html" in text
        assert "map.json" in text
        assert "b  trend     one page: 2 results of this arm over time" in text
        await pilot.press("e")
        assert isinstance(app.screen, FormDialog)
        (tmp_path / "line.csv").write_text("x_mm,y_mm\n1,2\n", encoding="utf-8")
        await pilot.press(*str(tmp_path / "line.csv"), "enter")
        await settled(app, pilot, link)
        await settled(app, pilot, link)
        output = str(tmp_path / "compensated-abc123.csv")
        words = ("compensate", str(tmp_path / "map.json"), "--path", str(tmp_path / "line.csv"))
        assert work_of(app).done[-1] == (*words, "--cell", "/bench/cell.toml", "-o", output)
        await pilot.press("b")
        await settled(app, pilot, link)
        await settled(app, pilot, link)
        assert work_of(app).done[-1][:2] == ("trend", "/bench/cell.toml")


async def test_corrected_commands_of_another_program_are_shown(tmp_path: Path) -> None:
    root, made = tmp_path / "runs", sample.hand_made()
    root.mkdir()
    of_run = made.provenance.model_copy(update={"runs": [RUN]})
    write_result(made.model_copy(update={"provenance": of_run}), tmp_path / "map.json")
    head = "# made by catseye 0.2 from map.json (error-map)\nx_mm,correction1_mdeg\n1.0,2.5\n"
    (tmp_path / "line.csv").write_text(head, encoding="utf-8")
    app = make_app(link := ScriptedLink(SNAPSHOT), "run", root=root)
    async with app.run_test(size=(120, 40)) as pilot:
        ended(link)
        assert "e  compensate shows line.csv" in await settled(app, pilot, link)
        await pilot.press("e")
        text = await shown(app, pilot)
        assert isinstance(app.screen, TextDialog)
        assert "x_mm,correction1_mdeg" in text
