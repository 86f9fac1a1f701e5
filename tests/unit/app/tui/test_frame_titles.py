"""Names of people, files and devices are no markup, also where they stand in the frame of a panel."""

import ast
from pathlib import Path

import pytest
from textual.widgets import Static

from catseye.app import tui
from catseye.app.tui.widgets.frame_text import set_subtitle, set_title
from tests.unit.app.tui.scripted import shown, started
from tests.unit.app.tui.scripted_run import SNAPSHOT

NAMES = ["[/x]", "[bold]", "[link=http://127.0.0.1]x", "a[/]b", "\\[x", "["]


@pytest.mark.parametrize("name", NAMES)
async def test_a_name_resembling_markup_stands_in_a_frame(name: str) -> None:
    async with started(SNAPSHOT, "bench") as (app, pilot, _):
        panel = app.screen.query(Static).first()
        set_title(panel, name)
        set_subtitle(panel, name)
        assert panel._border_title == panel._border_subtitle  # noqa: SLF001  # as it is painted
        assert str(panel._border_title) == name  # noqa: SLF001  # as it is painted
        await pilot.pause()


async def test_a_filter_resembling_markup_is_typed_on() -> None:
    async with started(SNAPSHOT, "runs", size=(120, 40)) as (app, pilot, _):
        await shown(app, pilot)
        await pilot.press("slash", *"[/x]")
        assert "/ [/x]" in await shown(app, pilot)


def test_only_one_module_sets_texts_of_frames() -> None:
    folder = Path(tui.__file__).parent
    found = {
        f"{path.relative_to(folder)}:{node.lineno}"
        for path in folder.rglob("*.py")
        if "border_" in (text := path.read_text("utf-8"))
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Assign) and not isinstance(node.value, ast.Constant)
        for target in node.targets
        for part in ast.walk(target)
        if isinstance(part, ast.Attribute) and part.attr in {"border_title", "border_subtitle"}
    }
    assert {place.partition(":")[0] for place in found} == {"widgets/frame_text.py"}
