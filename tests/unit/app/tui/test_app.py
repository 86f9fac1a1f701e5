"""Keys that work everywhere, and the ways out."""

from functools import partial
from typing import Any

import pytest
from textual.binding import Binding
from textual.screen import Screen
from textual.widgets import Button, Input, Static

from catseye.app.service.errors import ServiceError
from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from catseye.app.tui.dialogs.questions import ConfirmDialog, QuitDialog
from catseye.app.tui.main_screens import MAIN_SCREENS
from catseye.app.tui.screens.base import MainScreen
from catseye.app.tui.stopping import StopOp
from tests.unit.app.tui.scripted import ScriptedLink, make_app, shown, started
from tests.unit.app.tui.scripted_bench import BENCH
from tests.unit.app.tui.serial.scripted_arm import arm_bench

RUN = {
    "run": "20261121T090000Z_open-loop_abc123",
    "procedure": "open-loop",
    "title": "Open loop",
    "state": "EXECUTE",
}


def ops(link: ScriptedLink) -> list[str]:
    return link.ops


@pytest.mark.parametrize("dialog", [False, True])
async def test_stop_key_reaches_the_engine(dialog: bool) -> None:
    async with started(RUN) as (app, pilot, link):
        if dialog:
            app.push_screen(ErrorDialog("Something", "went wrong: try again"))
        await pilot.press("f12")
        await pilot.pause()
        assert ops(link) == ["stop"]


async def test_stop_key_works_in_the_palette_and_in_an_input() -> None:
    async with started(RUN) as (app, pilot, link):
        await pilot.press("ctrl+p")
        await pilot.pause()
        assert app.screen.query(Input)
        await pilot.press("f12")
        await pilot.pause()
        assert ops(link) == ["stop"]


async def test_buttons_are_labelled_and_only_f8_permits_motion() -> None:
    async with started(RUN) as (app, pilot, link):
        await shown(app, pilot)
        # A button takes the second click within 0.2 s for the first one's bounce; nobody waits for that here.
        app.screen.query_one("#hold", Button).active_effect_duration = 0.0
        await pilot.click("#hold")
        await pilot.pause()
        assert ops(link) == ["hold"]
        link.publish("state", run=RUN["run"], state="HELD", reason="at a checkpoint")
        assert "GO ON F8" in await shown(app, pilot)
        await pilot.click("#hold")
        assert "goes on where it was held" in await shown(app, pilot)
        await pilot.press("enter")
        await pilot.pause()
        assert ops(link) == ["hold"]
        link.now_s += 2.0
        await pilot.press("f8")
        await pilot.pause()
        assert ops(link) == ["hold", "control", "unhold"]


async def test_refusal_is_reported_with_its_remedy() -> None:
    link = ScriptedLink(RUN)
    link.refusals["hold"] = "the devices are being connected and nothing moves: hold when it runs, or stop"
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("h")
        text = await shown(app, pilot)
        assert isinstance(app.screen, ErrorDialog)
        assert "→ hold when it runs, or stop" in text


@pytest.mark.parametrize(("key", "asked", "ends"), [("1", [], False), ("2", ["hold"], False)])
async def test_quitting_asks_while_a_run_is_under_way(key: str, asked: list[str], ends: bool) -> None:
    async with started(RUN) as (app, pilot, link):
        await pilot.press("ctrl+q")
        await pilot.pause()
        assert isinstance(app.screen, QuitDialog)
        await pilot.press(key)
        await pilot.pause()
        assert ops(link) == asked
        assert link.left == [ends]


@pytest.mark.parametrize(
    ("bench", "said"),
    [
        ({"simulated": True, "emulated_speed": 20.0}, "keeps running, and ends with the engine"),
        ({"simulated": True}, "keeps running as long as the program that started it"),
        ({"simulated": False}, ""),
    ],
    ids=["of the engine", "of somebody else", "real"],
)
async def test_quitting_says_what_becomes_of_an_emulated_bench(bench: dict[str, Any], said: str) -> None:
    async with started({**RUN, **bench}) as (app, pilot, _link):
        await pilot.press("ctrl+q")
        assert "leave it running" in await shown(app, pilot)
        text = " ".join(str(each.render()) for each in app.screen.query(Static))
        assert said in text
        assert ("emulated bench" in text) == bool(said)


async def test_quitting_with_stop_waits_for_the_end_of_the_run() -> None:
    async with started(RUN) as (_app, pilot, link):
        await pilot.press("ctrl+q", "3")
        await pilot.pause()
        assert ops(link) == ["stop"]
        assert link.left == []
        ended: dict[str, Any] = {
            "status": "stopped",
            "exit_code": 5,
            "text": "",
            "path": "/bench",
            "drives_on": False,
        }
        link.publish("run-ended", **{**ended, "run": RUN["run"]})
        await pilot.pause()
        assert link.left == [True]


async def test_quitting_a_jog_stops_the_arm_or_stays_open(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async def nobody_hears(_: StopOp) -> None:
        raise ServiceError("no engine answers: use the emergency stop if the arm moves")

    link = ScriptedLink()
    link.publish("jog", on=True, by="Ada (tui-1)", percent=5.0, moving="j1")
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        with monkeypatch.context() as patch:
            patch.setattr(link, "stop", nobody_hears)
            await pilot.press("ctrl+q")
            await pilot.pause()
            assert "USE THE EMERGENCY STOP" in await shown(app, pilot)
            assert link.left == []
        await pilot.press("ctrl+q")
        await pilot.pause()
        assert (ops(link), link.left) == (["stop"], [True])


async def test_quitting_asks_while_a_command_works() -> None:
    async with started() as (app, pilot, link):
        with app.session.at_work("Identification"):
            for key, left in (("enter", []), ("escape", []), ("y", [True])):
                if not isinstance(app.screen, ConfirmDialog):
                    await pilot.press("ctrl+q")
                assert "Identification: it ends with this program" in await shown(app, pilot)
                await pilot.press(key)
                await pilot.pause()
                assert link.left == left


async def test_quitting_at_once_when_nothing_runs() -> None:
    async with started() as (_app, pilot, link):
        await pilot.press("ctrl+q")
        await pilot.pause()
        assert link.left == [True]


async def test_ctrl_c_stops_at_once_if_the_engine_is_silent() -> None:
    async with started(RUN) as (app, pilot, link):
        link.engine.silent_since_s = link.now_s - 4.0
        text = await shown(app, pilot)
        assert "THE ENGINE HAS NOT ANSWERED FOR 4.0 s" in text
        await pilot.press("ctrl+c")
        link.engine.lost("the engine is gone")
        text = await shown(app, pilot)
        assert f"{RUN['run']} is out of sight" in text
        await pilot.press("ctrl+c")
        await pilot.pause()
        assert ops(link) == ["stop", "stop"]


async def test_the_same_error_stands_there_once() -> None:
    link = ScriptedLink()
    link.refusals["stop"] = "no run is under way"
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("f12", "f12", "f12")
        await pilot.pause()
        assert [type(screen) for screen in app.screen_stack[1:]] == [ErrorDialog]


async def test_a_failing_panel_is_reported_once_and_stop_still_works(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError("a reflector at the axis")

    monkeypatch.setattr("catseye.app.tui.screens.bench.BenchScreen.show_state", fail)
    async with started(RUN) as (app, pilot, link):
        text = await shown(app, pilot)
        assert "A fault of this program" in text
        await pilot.press("escape")
        text = await shown(app, pilot)
        assert "A fault of this program" not in text
        assert "EXECUTE" in text
        await pilot.press("f12")
        await pilot.pause()
        assert ops(link) == ["stop"]


async def test_work_that_fails_is_shown() -> None:
    async def fail() -> None:
        raise ZeroDivisionError("a reflector at the axis")

    app = make_app(ScriptedLink())
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.pause()
        app.screen.run_worker(fail(), exit_on_error=False)
        await pilot.pause()
        assert "A fault of this program" in await shown(app, pilot)
        await pilot.press("escape")
        app.keep(fail())
        await pilot.pause()
        assert not isinstance(app.screen, ErrorDialog), "each fault is shown once"


BY_ANOTHER_NAME = {
    "action_begin": "_ask_to_begin",
    "action_move": "_ask_to_step",
    "action_move_axis": "_ask_to_step",
}
"""What moves the arm asks for F8 first where it was chosen by Enter."""

ALIKE = {"action_back": "action_cancel"}


@pytest.mark.parametrize("status", [BENCH, arm_bench()], ids=["scara", "six axes"])
async def test_each_screen_shows_stop_and_offers_its_actions(status: dict[str, Any]) -> None:
    link = ScriptedLink()
    app = make_app(link)
    async with app.run_test(size=(80, 24)) as pilot:
        link.publish("bench", **status)
        for size in ((80, 24), (120, 40)):
            await pilot.resize_terminal(*size)
            for name, entry in MAIN_SCREENS.items():
                await pilot.press(entry.key)
                text = await shown(app, pilot)
                assert app.current_mode == name
                assert "STOP F12" in text, (name, size)
                assert "no emergency stop" in text, (name, size)
                _look_at_palette(app.screen)


def _look_at_palette(screen: Screen[Any]) -> None:
    assert isinstance(screen, MainScreen)
    held = {_name_of(command.callback) for command in screen.commands()}
    for binding in type(screen).BINDINGS:
        assert isinstance(binding, Binding)
        assert binding.id
        name = binding.action.partition("(")[0]
        if not screen.check_action(name, ()):
            # The key means another action on this arm.
            continue
        action = f"action_{name}"
        assert held & {
            action,
            BY_ANOTHER_NAME.get(action),
            ALIKE.get(action),
            f"action_ask_to{action[6:]}",
        }, (screen.SCREEN, action)


def _name_of(callback: Any) -> str:
    return str(callback.func.__name__ if isinstance(callback, partial) else callback.__name__)


async def test_a_settings_check_while_exiting_starts_no_task() -> None:
    """The fixture that looks for tasks fails where the look begins all the same."""
    app = make_app(ScriptedLink())
    async with app.run_test(size=(80, 24)):
        pass
    app._look_at_settings()  # noqa: SLF001  # as its timer does
    assert not app._tasks  # noqa: SLF001  # what goes on beside the screens
