"""The run screen: questions, and every key that answers them."""

from typing import Any

import pytest
from textual.widgets import Button, Input

from catseye.app.protocol.requests import Control
from catseye.app.tui.dialogs.questions import MotionDialog
from catseye.app.tui.run_state import SoFar
from catseye.app.tui.screens.run import RunScreen
from catseye.app.tui.widgets.key_line import KeyLine
from tests.unit.app.tui import scripted
from tests.unit.app.tui.screens.run_screen import answers, app_of, ops, run_screen, settled
from tests.unit.app.tui.scripted import ScriptedLink, changed_screen, shown
from tests.unit.app.tui.scripted_run import MOTION, SNAPSHOT, TURNED, ask, measure, publish, show_value

SIZES = [(80, 24), (120, 40)]


@pytest.mark.parametrize("size", SIZES)
async def test_a_question_before_a_motion(size: tuple[int, int]) -> None:
    async with run_screen(size=size) as (app, pilot, link):
        measure(link)
        ask(link, **MOTION)
        text = await settled(app, pilot, link)
        assert "J1 -6.67°, J2 11.67°, J3 50.0 mm, J4 2.76°" in text
        assert "20 % override" in text
        assert not changed_screen(f"run-motion-{size[0]}x{size[1]}", text)


@pytest.mark.parametrize("size", SIZES)
async def test_the_question_for_the_turned_interferometer(size: tuple[int, int]) -> None:
    async with run_screen(size=size) as (app, pilot, link):
        measure(link)
        ask(link, **TURNED)
        show_value(link, "signal", 0.93, 0.1, 1.0, "")
        text = await settled(app, pilot, link)
        assert "turned by 180° on the flange" in text
        assert not changed_screen(f"run-turned-{size[0]}x{size[1]}", text)


async def test_a_key_pressed_as_the_question_comes_answers_nothing() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, **MOTION)
        await shown(app, pilot)
        await pilot.press("f8", "n")
        await shown(app, pilot)
        assert answers(link) == []


async def test_a_key_pressed_before_the_question_was_seen_answers_nothing() -> None:
    async with run_screen() as (app, pilot, link):
        await settled(app, pilot, link)
        ask(link, **MOTION)
        # The screen was busy with something else for so long.
        link.now_s += 5.0
        await shown(app, pilot)
        await app.workers.wait_for_complete()
        await shown(app, pilot)
        await pilot.press("f8")
        await shown(app, pilot)
        assert answers(link) == []


@pytest.mark.parametrize("until_it_repeats_s", [0.033, 0.25, 0.5, 0.66, 1.0])
async def test_f8_held_down_answers_one_question_only(until_it_repeats_s: float) -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, **MOTION)
        await settled(app, pilot, link)
        await pilot.press("f8")
        ask(link, **{**MOTION, "id": "stage/2"})
        await scripted.settled(app, pilot)
        link.now_s += until_it_repeats_s
        for _ in range(60):
            await pilot.press("f8")
            link.now_s += 0.033
        assert "then press F8 once" in await shown(app, pilot)
        assert answers(link) == [("stage/1", "yes")]
        link.now_s += 1.2
        await pilot.press("f8")
        await shown(app, pilot)
        assert answers(link)[1:] == [("stage/2", "yes")]


async def test_f8_held_down_before_the_question_answers_nothing() -> None:
    async with run_screen() as (app, pilot, link):
        await scripted.settled(app, pilot)
        await pilot.press("f8")
        ask(link, **MOTION)
        await scripted.settled(app, pilot)
        for _ in range(60):
            link.now_s += 0.033
            await pilot.press("f8")
        assert answers(link) == []


async def test_a_question_hidden_behind_a_screen_ignores_immediate_answers() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, **MOTION)
        await settled(app, pilot, link)
        await pilot.press("f2")
        link.now_s += 60.0
        await shown(app, pilot)
        await pilot.press("f4", "f8")
        await shown(app, pilot)
        assert answers(link) == []
        link.now_s += 2.0
        await shown(app, pilot)
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert answers(link) == [("stage/1", "yes")]


async def test_the_palette_asks_for_f8_before_a_motion() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, **MOTION)
        await settled(app, pilot, link)
        screen = app.screen
        assert isinstance(screen, RunScreen)
        for key in ("enter", "escape", "f8"):
            command = next(each for each in screen.commands() if each.title == "Answer: let the arm move")
            command.callback()
            text = await shown(app, pilot)
            assert isinstance(app.screen, MotionDialog)
            assert "J1 -6.67°, J2 11.67°, J3 50.0 mm, J4 2.76°" in text
            await pilot.press(key)
            await settled(app, pilot, link)
            assert answers(link) == ([("stage/1", "yes")] if key == "f8" else [])
            if key == "enter":
                await pilot.press("escape")
        command.callback()
        await shown(app, pilot)
        ask(link, **{**MOTION, "id": "stage/2"})
        await settled(app, pilot, link)
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert len(answers(link)) == 1


async def test_the_key_that_moves_the_arm_cannot_be_clicked() -> None:
    async with run_screen(size=(200, 60)) as (app, pilot, link):
        ask(link, **MOTION)
        text = await settled(app, pilot, link)
        keys = app.screen.query_one(KeyLine).render().plain
        assert "- " in keys
        assert "F8" not in keys
        for y, line in enumerate(text.splitlines()):
            if "F8" in line:
                await pilot.click(offset=(line.index("F8") + 1, y))
        await settled(app, pilot, link)
        assert answers(link) == []
        screen = app.screen
        assert isinstance(screen, RunScreen)
        screen.action_ask_to_move()
        await shown(app, pilot)
        assert "F8" not in app.screen.query_one(KeyLine).render().plain


async def test_a_refused_answer_is_shown_beside_the_question() -> None:
    link = ScriptedLink(SNAPSHOT)
    link.refusals["answer"] = "'here' is not an answer to 'jog/P1': type a number"
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, id="jog/P1", kind="text", text="Type it.")
        await settled(app, pilot, link)
        await pilot.press(*"here", "enter")
        text = await settled(app, pilot, link)
        assert "✗ 'here' is not an answer" in text
        assert "Type it." in text
        await pilot.press("x")
        assert "✗" not in await shown(app, pilot)


async def test_a_question_is_announced_everywhere_and_focused_when_shown() -> None:
    async with run_screen() as (app, pilot, link):
        await shown(app, pilot)
        await pilot.press("f2")
        ask(link, id="height", kind="number", text="How high is it?", unit="mm")
        text = await shown(app, pilot)
        assert "QUESTION: F4" in text
        await pilot.press("f4")
        await settled(app, pilot, link)
        assert isinstance(app.focused, Input)
        await pilot.press("7", "enter")
        await settled(app, pilot, link)
        assert answers(link) == [("height", "7")]


async def test_control_is_taken_before_an_answer_when_nobody_has_it() -> None:
    async with run_screen({**SNAPSHOT, "control": None}) as (app, pilot, link):
        ask(link, **MOTION)
        await settled(app, pilot, link)
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert ops(link) == ["control", "answer"]


async def test_somebody_elses_control_is_named_and_can_be_taken() -> None:
    controlled = {**SNAPSHOT, "control": {"client": "attach-2", "who": "Bob"}}
    async with run_screen(controlled, size=(120, 40)) as (app, pilot, link):
        ask(link, **MOTION)
        text = await settled(app, pilot, link)
        assert "Bob (attach-2) answers; a takes control" in text
        await pilot.press("a", "y")
        await settled(app, pilot, link)
        assert link.asked == [Control(force=True)]
        await pilot.press("a")
        await shown(app, pilot)
        assert ops(link) == ["control", "release"]


async def test_the_time_to_answer_follows_the_runs_clock() -> None:
    question: dict[str, Any] = {
        "id": "a",
        "kind": "choice",
        "text": "Which?",
        "choices": ["x", "y"],
        "unit": "",
        "task": None,
        "timeout_s": 1200.0,
        "safe_answer": "y",
        "motion": False,
    }
    async with run_screen(
        {**SNAPSHOT, "simulated": True, "prompt": question, "prompt_open_s": 15.0}, size=(120, 40)
    ) as (app, pilot, link):
        run = link.engine.run
        assert run is not None
        measure(link)
        run.take_record(SoFar([], 0, [], speed=20.0))
        text = await settled(app, pilot, link)
        # 1200 bench seconds are a minute here; 15 s of it had passed before this client came, and one since.
        assert "44 s left, then y" in text
        assert "bench time" in text


async def test_no_answer_is_requested_while_stopping() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, **MOTION)
        assert "Answer the question" in await settled(app, pilot, link)
        publish(link, "state", state="STOPPING", reason="Ada stops the run")
        text = await shown(app, pilot)
        assert "Answer the question" not in text
        assert "Wait for standstill: Ada stops the run" in text


async def test_motion_is_confirmed_by_f8_alone_and_refused_by_n() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, **MOTION)
        await settled(app, pilot, link)
        await pilot.press("enter", "y", "space", "1", "escape")
        text = await shown(app, pilot)
        assert answers(link) == []
        assert "F8 confirms it" in text
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert answers(link) == [("stage/1", "yes")]
        ask(link, **{**MOTION, "id": "stage/2"})
        await settled(app, pilot, link)
        await pilot.press("n")
        await settled(app, pilot, link)
        assert answers(link)[1:] == [("stage/2", "no")]


CONFIRMATIONS: tuple[tuple[str | None, str, str], ...] = (
    (None, "y", "yes"),
    (None, "n", "no"),
    ("yes", "enter", "yes"),
    (None, "enter", "no"),
)


async def test_a_confirmation_has_its_safe_answer_in_focus() -> None:
    async with run_screen() as (app, pilot, link):
        for number, (safe, key, answer) in enumerate(CONFIRMATIONS):
            case = (safe, key)
            ask(link, id=f"place/{number}", kind="confirm", text="Put it there.", safe_answer=safe)
            await settled(app, pilot, link)
            focused = app.focused
            assert isinstance(focused, Button), case
            assert focused.name == (safe or "no"), case
            await pilot.press("f8")
            await shown(app, pilot)
            assert answers(link)[number:] == [], case
            await pilot.press(key)
            await settled(app, pilot, link)
            assert answers(link)[number:] == [(f"place/{number}", answer)], case


CHOICES = ["retry", "skip", "stop"]
MOVING: dict[str, Any] = {"motion": True, "safe_answer": "stop", "rests_after": ["stop"]}


async def test_a_choice_takes_its_number_only() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, id="beam/1", kind="choice", text="Which?", choices=CHOICES)
        text = await settled(app, pilot, link)
        assert "1  retry" in text
        await pilot.press("enter", "9", "y", "n")
        await shown(app, pilot)
        assert answers(link) == []
        await pilot.press("2")
        await settled(app, pilot, link)
        assert answers(link) == [("beam/1", "skip")]


async def test_choices_that_move_the_arm_need_f8() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, id="beam/2", kind="choice", text="Which?", choices=["retry", "stop"], **MOVING)
        await settled(app, pilot, link)
        await pilot.press("1")
        assert "F8 confirms it" in await shown(app, pilot)
        assert answers(link) == []
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert answers(link) == [("beam/2", "retry")]


async def test_every_choice_but_resting_ones_needs_f8() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, id="beam/3", kind="choice", text="?", choices=CHOICES, **MOVING)
        text = await settled(app, pilot, link)
        assert [button.name for button in app.screen.query("#answers Button").results(Button)] == ["stop"]
        assert "2 F8  skip: arm moves" in text
        await pilot.press("2")
        assert "the arm moves after skip: F8 confirms it" in await shown(app, pilot)
        assert answers(link) == []
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert answers(link) == [("beam/3", "skip")]


async def test_f8_alone_takes_the_first_choice() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, id="beam/4", kind="choice", text="?", choices=CHOICES, **MOVING)
        await settled(app, pilot, link)
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert answers(link) == [("beam/4", "retry")]


async def test_a_safe_answer_that_drives_on_needs_f8() -> None:
    drives_on = MOVING | {"safe_answer": "skip", "rests_after": []}
    async with run_screen() as (app, pilot, link):
        ask(link, id="beam/5", kind="choice", text="?", choices=["again", "take", "skip"], **drives_on)
        text = await settled(app, pilot, link)
        assert "3 F8  skip: arm moves" in text
        await pilot.press("3", "enter")
        assert "the arm moves after skip: F8 confirms it" in await shown(app, pilot)
        assert answers(link) == []
        assert isinstance(app.screen, RunScreen)
        app.screen.action_ask_to_move()
        assert "The answer is: skip" in await shown(app, pilot)
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert answers(link) == [("beam/5", "skip")]


async def test_the_time_to_answer_counts_down() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, id="a", kind="choice", text="Which?", choices=["x", "y"], timeout_s=60.0, safe_answer="y")
        assert "59 s left, then y" in await settled(app, pilot, link)
        link.now_s += 29.0
        assert "29 s left, then y" in await shown(app, pilot)


async def test_typed_answers_are_checked_and_cleared_on_withdrawal() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, id="height", kind="number", text="How high is it?", unit="mm")
        text = await settled(app, pilot, link)
        assert isinstance(app.focused, Input)
        assert " mm" in text
        await pilot.press("enter", "1", "x")
        assert "type a number in mm" in await shown(app, pilot)
        await pilot.press("enter")
        await shown(app, pilot)
        assert answers(link) == []
        await pilot.press("backspace", "full_stop", "5", "enter")
        await settled(app, pilot, link)
        assert answers(link) == [("height", "1.5")]
        ask(link, id="jog/P1", kind="text", text="Type degrees, here or skip.", unit="deg")
        await settled(app, pilot, link)
        await pilot.press("enter")
        assert "type an answer in deg" in await shown(app, pilot)
        await pilot.press(*"here", "enter")
        await settled(app, pilot, link)
        assert answers(link)[1:] == [("jog/P1", "here")]
        ask(link, id="height/2", kind="number", text="How high is it?", unit="mm")
        await settled(app, pilot, link)
        await pilot.press("1", "2")
        publish(link, "answer", id="height/2", answer="3", who="Bob (attach-2)")
        text = await settled(app, pilot, link)
        assert "How high" not in text
        await pilot.press("enter", "y")
        await shown(app, pilot)
        assert answers(link)[2:] == []
        assert not app.screen.query("#prompt Input")


async def test_stop_and_ladder_from_within_an_input() -> None:
    async with run_screen() as (app, pilot, link):
        for kind in ("number", "text"):
            link.asked.clear()
            ask(link, id=kind, kind=kind, text="What?")
            await settled(app, pilot, link)
            await pilot.press("h", "o", "n", "f12", "ctrl+c")
            await shown(app, pilot)
            assert ops(link) == ["stop", "ladder"], kind
            assert isinstance(app.focused, Input), kind
            assert app.focused.value == "hon", kind


async def test_typed_answers_move_the_arm_only_with_f8() -> None:
    async with run_screen() as (app, pilot, link):
        for kind in ("text", "number"):
            link.asked.clear()
            ask(link, id=kind, kind=kind, text="By how much?", unit="deg", safe_answer="skip", motion=True)
            assert "THE ARM THEN MOVES, as the answer says" in await settled(app, pilot, link), kind
            await pilot.press("f8")
            assert "✗ type a" in await shown(app, pilot), kind
            await pilot.press("1", "enter")
            assert "the arm moves after 1: F8 confirms it" in await shown(app, pilot), kind
            await settled(app, pilot, link)
            assert answers(link) == [], kind
            await pilot.press("f8")
            await settled(app, pilot, link)
            assert answers(link) == [(kind, "1")]


async def test_a_typed_answer_that_moves_nothing_needs_no_f8() -> None:
    async with run_screen() as (app, pilot, link):
        ask(link, id="walk/waiver", kind="text", text="Why without a walk?", motion=True, rests_after=["no"])
        await settled(app, pilot, link)
        await pilot.press("n", "o", "f8")
        assert "the arm does not move after this" in await settled(app, pilot, link)
        assert answers(link) == []
        await pilot.press("enter")
        await settled(app, pilot, link)
        assert answers(link) == [("walk/waiver", "no")]


async def test_other_sizes_do_not_crash() -> None:
    async with run_screen(size=(40, 12)) as (app, pilot, link):
        measure(link)
        ask(link, **MOTION)
        await settled(app, pilot, link)
        for size in ((60, 20), (100, 30), (200, 60), (40, 12)):
            await pilot.resize_terminal(*size)
            assert "F8" in await shown(app, pilot) or size[1] < 20, size
