"""`?` lists the keys of a screen and carries one out; F1 explains the terms."""

import pytest
from textual.widgets import Input, OptionList

from catseye.app.tui.dialogs.box_dialog import BoxDialog
from catseye.app.tui.dialogs.search_dialog import SearchDialog
from catseye.app.tui.keys import lets_move
from catseye.app.tui.main_screens import MAIN_SCREENS
from catseye.app.tui.widgets.row_table import RowTable
from tests.unit.app.tui.scripted import changed_screen, shown, started
from tests.unit.app.tui.scripted_run import MOTION, SNAPSHOT, ask


@pytest.mark.parametrize("screen", MAIN_SCREENS)
async def test_question_mark_lists_the_keys_of_every_screen(screen: str) -> None:
    async with started(SNAPSHOT, screen, size=(120, 40)) as (app, pilot, _):
        if isinstance(app.focused, Input):
            app.set_focus(None)
        named = {
            one.binding.id for one in app.screen.active_bindings.values() if one.binding.id and one.enabled
        }
        await pilot.press("question_mark")
        await shown(app, pilot)
        assert isinstance(app.screen, SearchDialog)
        listed = {option.id for option in app.screen.query_one(OptionList).options if option.id}
        assert listed == named
        assert {"run.stop", "app.keys", f"go.{screen}"} <= listed


async def test_typing_filters_and_enter_carries_out() -> None:
    async with started(SNAPSHOT, "run", size=(80, 24)) as (app, pilot, _):
        await pilot.press("question_mark", *"devices arm")
        text = await shown(app, pilot)
        assert "Bench: devices, arm, beam and air at present" in text
        assert not changed_screen("keys-80x24", text)
        await pilot.press("enter")
        await shown(app, pilot)
        assert app.current_mode == "bench"


async def test_keys_that_move_the_arm_are_not_carried_out() -> None:
    async with started(SNAPSHOT, "run", size=(80, 24)) as (app, pilot, link):
        ask(link, **MOTION)
        await shown(app, pilot)
        for typed in ("let the arm move", "hold: the walk"):
            await pilot.press("question_mark", *typed, "enter")
            await shown(app, pilot)
            notes = [note.message for note in app._notifications]  # noqa: SLF001  # what was said
            assert "this lets the arm move: press its own key" in notes, typed
            app.clear_notifications()
        assert link.asked == []


@pytest.mark.parametrize("name", ["jog.j1-plus", "jog.axis-minus", "jog.point", "start.begin", "run.go-on"])
def test_keys_that_move_the_arm_are_known(name: str) -> None:
    assert lets_move(name)
    assert not lets_move("jog.view")


@pytest.mark.parametrize("screen", MAIN_SCREENS)
async def test_every_screen_names_its_help_first(screen: str) -> None:
    async with started(SNAPSHOT, screen, size=(80, 24)) as (app, pilot, _):
        if isinstance(app.focused, Input):
            app.set_focus(None)
        assert (await shown(app, pilot)).splitlines()[-1].startswith("? keys")


async def test_a_dialog_has_its_help() -> None:
    async with started(SNAPSHOT, "run", size=(80, 24)) as (app, pilot, link):
        app.show_error("Something failed", "somewhere")
        assert "? keys" in await shown(app, pilot)
        dialog = app.screen
        await pilot.press("question_mark")
        await shown(app, pilot)
        assert isinstance(app.screen, SearchDialog)
        listed = {option.id for option in app.screen.query_one(OptionList).options if option.id}
        assert {"app.help", "app.keys", "dialog.copy"} <= listed
        assert "run.hold" not in listed
        # No list above a list.
        await pilot.press("f1", "escape")
        await shown(app, pilot)
        assert app.screen is dialog
        await pilot.press("f1")
        assert "What the terms mean" in await shown(app, pilot)
        await pilot.press("escape", "question_mark", *"close", "enter")
        await shown(app, pilot)
        assert not isinstance(app.screen, BoxDialog)
        assert link.asked == []


async def test_question_mark_is_typed_into_a_filter() -> None:
    async with started(SNAPSHOT, "runs", size=(80, 24)) as (app, pilot, _):
        await pilot.press("slash", "question_mark")
        assert isinstance(app.focused, RowTable)
        assert app.focused.typed == "?"


async def test_question_mark_is_typed_into_a_line() -> None:
    async with started(SNAPSHOT, "terminal", size=(80, 24)) as (app, pilot, _):
        await pilot.press("slash", "question_mark")
        assert isinstance(app.focused, Input)
        assert app.focused.value == "?"


async def test_f1_explains_terms_and_searches_them() -> None:
    async with started(SNAPSHOT, "results", size=(80, 24)) as (app, pilot, _):
        await pilot.press("f1", *"dead path")
        text = await shown(app, pilot)
        assert "Constant part of every distance" in text
        assert not changed_screen("glossary-80x24", text)
        await pilot.press("escape")
        await shown(app, pilot)
        assert not isinstance(app.screen, SearchDialog)
