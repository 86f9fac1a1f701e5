"""A run begins on the cell file that this program shows, wherever the engine was started."""

from pathlib import Path

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.protocol.requests import Start
from catseye.app.tui.dialogs.questions import ConfirmDialog
from tests.unit.app.tui.screens.surveyed import app_of
from tests.unit.app.tui.scripted import ScriptedLink, make_app, settled, shown
from tests.unit.app.tui.scripted_bench import BENCH


async def test_a_relative_cell_path_is_sent_as_absolute(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    link = ScriptedLink({"cell": str(tmp_path / "cell.toml")})
    app = app_of(link)
    app.session.cell = Path("cell.toml")
    async with app.run_test(size=(80, 24)) as pilot:
        link.publish("bench", **BENCH)
        await settled(app, pilot)
        await pilot.press("ctrl+s")
        await settled(app, pilot)
        await pilot.press("f8")
        await settled(app, pilot)
        (start,) = link.asked_for(Start)
        assert start.cell == str(tmp_path / "cell.toml")


@pytest.mark.parametrize(
    ("refusal", "used"), [("", "own"), ("this needs control, which Bob holds", "engine's")]
)
async def test_the_app_keeps_the_cell_of_a_surviving_engine(tmp_path: Path, refusal: str, used: str) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(TEMPLATE, encoding="utf-8")
    link = ScriptedLink()
    if refusal:
        link.refusals["shutdown"] = refusal
    app = make_app(link, cell=cell)
    async with app.run_test(size=(80, 24)) as pilot:
        await shown(app, pilot)
        assert isinstance(app.screen, ConfirmDialog)
        await pilot.press("y")
        for _ in range(3):
            await shown(app, pilot)
        assert link.ops == ["control", "shutdown"]
        assert app.session.cell == (cell if used == "own" else Path("/bench/cell.toml"))
