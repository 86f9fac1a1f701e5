"""The screen Set-up: from nothing to a cell file of an arm whose motion resolution is measured."""

from pathlib import Path

import pytest
from textual.widgets import Select

from catseye.app.cell.load import load_cell
from catseye.app.cell.templates import RESOLUTION
from catseye.app.tui.session import EMULATED_ARM
from catseye.app.tui.setup.emulators import emulated_cell, free_file, is_emulated
from catseye.app.tui.setup.question_row import QuestionRow
from tests.unit.app.tui.screens.test_setup import (
    ENDPOINTS,
    begin,
    first_start,
    judged,
    type_answer,
    wizard_of,
)
from tests.unit.app.tui.scripted import changed_screen, settled


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


async def test_another_system_has_other_pages_and_becomes_a_cell(folder: Path) -> None:
    app, _ = first_start()
    async with app.run_test(size=(80, 24)) as pilot:
        wizard = await begin(app, pilot)
        await type_answer(app, pilot, "name", "kuka-7")
        rows = app.screen.query(QuestionRow)
        row = next(row for row in rows if row.question.key == "system")
        row.query_one(Select).value = RESOLUTION
        text = await settled(app, pilot)
        assert "Reflectors" not in text
        for page in wizard.draft.pages:
            await wizard_of(app).show_page(page)
            for key, answer in {**ENDPOINTS, "angular_optics.spacing_mm": "32.61"}.items():
                if any(row.question.key == key for row in app.screen.query(QuestionRow)):
                    await type_answer(app, pilot, key, answer)
            if page.name in {"robot", "angular_optics"}:
                assert not changed_screen(f"setup_resolution_{page.name}_80x24", await judged(app, pilot))
        assert "all checks passed" in await judged(app, pilot)
        await pilot.press("ctrl+s")
        await settled(app, pilot)
    cell = load_cell(folder / "cell.toml").cell
    assert (cell.name, cell.robot.driver, cell.robot.arm) == ("kuka-7", "kuka-varproxy", "kr210-r2700")
    assert cell.angular_optics is not None
    assert cell.angular_optics.spacing_mm == 32.61


def test_the_emulated_arm_has_a_cell_file_of_its_own(folder: Path) -> None:
    path = free_file(folder, RESOLUTION)
    assert path.name == f"{EMULATED_ARM}.toml"
    path.write_text(emulated_cell(RESOLUTION), encoding="utf-8")
    assert is_emulated(path, RESOLUTION)
    assert not is_emulated(path, "scara")
    cell = load_cell(path).cell
    ports = {section.endpoint.rpartition(":")[2] for section in cell.instruments.values()}
    assert len(ports) == len(cell.instruments) == 4
