"""What is painted anew: nothing where nothing has changed, and no layout for a text whose place is fixed."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from textual.widget import Widget

from catseye.app.tui.main_screens import MAIN_SCREENS
from tests.unit.app.tui.scripted import ScriptedLink, make_app, settled
from tests.unit.app.tui.scripted_bench import BENCH
from tests.unit.app.tui.scripted_run import SNAPSHOT, measure

SIZE = (120, 40)


@contextmanager
def refreshes(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[tuple[str, bool]]]:
    """Note each widget that asks to be painted anew, and whether with a layout."""
    seen: list[tuple[str, bool]] = []
    refresh = Widget.refresh

    def noted(self: Widget, *regions: Any, layout: bool = False, **how: Any) -> Widget:
        seen.append((f"{type(self).__name__}#{self.id}", layout))
        return refresh(self, *regions, layout=layout, **how)

    with monkeypatch.context() as patched:
        patched.setattr(Widget, "refresh", noted)
        yield seen


@pytest.mark.parametrize("screen", MAIN_SCREENS)
async def test_what_has_not_changed_is_not_painted_again(
    screen: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    link = ScriptedLink(SNAPSHOT)
    app = make_app(link, screen)
    async with app.run_test(size=SIZE) as pilot:
        link.publish("bench", **BENCH)
        measure(link)
        await settled(app, pilot)
        with refreshes(monkeypatch) as seen:
            shown = app.screen_stack[0]
            shown.show_now()  # type: ignore[attr-defined]  # every main screen has it
        assert seen == []


async def test_steps_and_log_need_no_layout(monkeypatch: pytest.MonkeyPatch) -> None:
    link = ScriptedLink(SNAPSHOT)
    app = make_app(link, "run")
    async with app.run_test(size=SIZE) as pilot:
        await settled(app, pilot)
        measure(link)
        with refreshes(monkeypatch) as seen:
            app.screen_stack[0].show_now()  # type: ignore[attr-defined]  # every main screen has it
    assert {("StepList#steps", False), ("RunLog#log", False)} <= set(seen)
    assert {("StepList#steps", True), ("RunLog#log", True)}.isdisjoint(seen)
