"""What a start says of keys and cell files that cannot be used, and the engine of another cell."""

from io import BytesIO, TextIOWrapper
from pathlib import Path

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.errors import UsageError
from catseye.app.tui import start
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from catseye.app.tui.dialogs.questions import ConfirmDialog
from catseye.app.tui.key_table import key_table
from catseye.app.tui.session import Session
from catseye.app.tui.start_checks import cell_fault, key_clashes, unknown_names
from tests.unit.app.tui.scripted import ScriptedLink, ScriptedWork, make_app, shown, started


def test_unknown_names_suggest_the_nearest() -> None:
    assert unknown_names(frozenset({"go.jog", "run.hold"})) == ""
    text = unknown_names(frozenset({"go.jogg", "run.hold"}))
    assert "go.jogg: no such name; did you mean go.jog?" in text
    assert "run.hold" not in text


def test_keys_that_two_things_have_are_shown() -> None:
    assert key_clashes({"run.hold": "h,insert", "go.jog": "f5"}) == ""
    assert key_clashes({"go.jog": "f6", "go.results": "f5"}) == "", "two keys are exchanged"
    assert key_clashes({"run.hold": "h,f4"}) == "run.hold = f4: go.run (everywhere) has it, too"
    assert "bench.view (Bench) has it, too" in key_clashes({"go.jog": "v"})
    assert key_clashes({"bench.view": "x"}) == "", "another screen has it"


def test_a_cell_file_is_judged_by_its_model(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    assert cell_fault(path) == ""
    path.write_text(TEMPLATE, encoding="utf-8")
    assert cell_fault(path) == ""
    path.write_text(TEMPLATE.replace("link1_mm = 325.0", "link1_mm = -1"), encoding="utf-8")
    assert "robot.link1_mm" in cell_fault(path)


def test_names_belong_to_one_action_within_a_screen() -> None:
    places = [(key.where, key.name) for key in key_table()]
    assert len(places) == len(set(places))


async def test_trouble_before_the_start_is_shown_in_a_dialog() -> None:
    link = ScriptedLink()
    session = Session(link, ScriptedWork(), Path("runs"), Path("/bench/cell.toml"), lambda: link.now_s)
    app = CatseyeApp(session, {"go.jogg": "f5"}, "bench", ("Your keys are not used", "keys.toml: wrong"))
    async with app.run_test(size=(80, 24)) as pilot:
        for _ in range(600):
            await pilot.pause(0.01)
            if len([one for one in app.screen_stack if isinstance(one, ErrorDialog)]) == 2:
                break
        assert "did you mean go.jog?" in await shown(app, pilot)
        await pilot.press("escape")
        assert "Your keys are not used" in await shown(app, pilot)


async def test_an_engine_of_another_cell_is_asked_about(tmp_path: Path) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(TEMPLATE, encoding="utf-8")
    async with started(cell=cell) as (app, pilot, link):
        await shown(app, pilot)
        assert isinstance(app.screen, ConfirmDialog)
        await pilot.press("escape")
        await pilot.pause()
        assert app.session.cell == Path("/bench/cell.toml")
        assert [one for one in link.asked if one.op == "shutdown"] == []


async def test_another_cells_engine_is_left_alone_during_a_run(tmp_path: Path) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(TEMPLATE, encoding="utf-8")
    link = ScriptedLink(
        {"run": "20261121T090000Z_open-loop_abc123", "procedure": "open-loop", "title": "Open loop"}
    )
    app = make_app(link, cell=cell)
    async with app.run_test(size=(80, 24)) as pilot:
        await shown(app, pilot)
        assert not isinstance(app.screen, ConfirmDialog)


@pytest.mark.parametrize(("text", "fault"), [(None, "no such file"), ("a = 1\n", "not a cell file")])
def test_a_wrong_cell_option_is_refused(
    tmp_path: Path, text: str | None, fault: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "cell.toml"
    if text is not None:
        path.write_text(text, encoding="utf-8")
    for stream in ("stdin", "stdout", "stderr"):
        monkeypatch.setattr(f"sys.{stream}.isatty", lambda: True, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    with pytest.raises(UsageError, match=fault):
        start.show(path, tmp_path / "runs", 1.0)


@pytest.mark.parametrize(
    ("term", "encoding", "fault"),
    [("dumb", "utf-8", "TERM is not set, or dumb"), ("xterm", "latin-1", "LANG=C.UTF-8 catseye tui")],
)
def test_terminals_that_cannot_show_it_are_refused(
    term: str, encoding: str, fault: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    terminal = TextIOWrapper(BytesIO(), encoding=encoding)
    monkeypatch.setattr(terminal, "isatty", lambda: True, raising=False)
    for stream in ("stdin", "stdout", "stderr"):
        monkeypatch.setattr(f"sys.{stream}", terminal)
    monkeypatch.setenv("TERM", term)
    with pytest.raises(UsageError, match=fault):
        start.show(None, tmp_path / "runs", 1.0)
