"""The theme is remembered, and nothing that is wrong with the file prevents a start."""

from pathlib import Path

import pytest

from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.preferences import remember_theme, remembered_theme
from catseye.app.tui.themes import DARK, LIGHT
from tests.unit.app.tui.scripted import ScriptedLink, make_app, settled

KNOWN = frozenset({DARK.name, LIGHT.name})


def test_a_theme_is_read_back(tmp_path: Path) -> None:
    file = tmp_path / "new" / "remembered.toml"
    remember_theme(file, LIGHT.name)
    assert remembered_theme(file, KNOWN, DARK.name) == LIGHT.name
    assert [path.name for path in file.parent.iterdir()] == ["remembered.toml"]


@pytest.mark.parametrize("data", [b"", b"theme = 3", b"theme = ", b"\xff\x00", b'theme = "gone"', b"[theme]"])
def test_a_damaged_file_gives_the_default(tmp_path: Path, data: bytes) -> None:
    file = tmp_path / "remembered.toml"
    file.write_bytes(data)
    assert remembered_theme(file, KNOWN, DARK.name) == DARK.name


def test_a_missing_file_or_a_folder_gives_the_default(tmp_path: Path) -> None:
    assert remembered_theme(tmp_path / "none.toml", KNOWN, DARK.name) == DARK.name
    assert remembered_theme(tmp_path, KNOWN, DARK.name) == DARK.name


def app_with(file: Path) -> CatseyeApp:
    return CatseyeApp(make_app(ScriptedLink()).session, preferences=file)


async def test_a_chosen_theme_is_there_at_the_next_start(tmp_path: Path) -> None:
    file = tmp_path / "remembered.toml"
    app = app_with(file)
    async with app.run_test() as pilot:
        assert app.theme == DARK.name
        app.theme = LIGHT.name
        await settled(app, pilot)
        for _ in range(50):
            if file.exists():
                break
            await pilot.pause(0.02)
    assert app_with(file).theme == LIGHT.name


async def test_a_theme_that_cannot_be_written_is_only_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder", encoding="utf-8")
    app = app_with(tmp_path / "file" / "remembered.toml")
    async with app.run_test() as pilot:
        app.theme = LIGHT.name
        await settled(app, pilot)
        assert app.theme == LIGHT.name
        assert app.is_running
