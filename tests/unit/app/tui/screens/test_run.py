"""The run screen: what it shows, and every key that it has."""

from pathlib import Path
from typing import Any

import pytest
from textual.pilot import Pilot
from textual.widgets import Button, Input
from textual.widgets._footer import FooterKey  # noqa: PLC2701  # Textual has no public name for it

from app.tui.app import CatseyeApp
from app.tui.dialogs.error_dialog import ErrorDialog
from app.tui.dialogs.motion_dialog import MotionDialog
from app.tui.dialogs.override_dialog import OverrideDialog
from app.tui.dialogs.start_dialog import StartDialog
from app.tui.run_picture import SoFar
from app.tui.screens.run import RunScreen
from app.tui.work import Done
from tests.unit.app.tui.scripted import ScriptedLink, compare, make_app, shown, work_of
from tests.unit.app.tui.told_bench import BENCH
from tests.unit.app.tui.told_run import MOTION, REHEARSAL, RUN, SNAPSHOT, ask, end, measure, show_value, tell

SIZES = [(80, 24), (120, 40)]


def app_of(link: ScriptedLink) -> CatseyeApp:
    app = make_app(link, "run")
    work_of(app).outcomes["run"] = REHEARSAL
    return app


async def settled(app: CatseyeApp, pilot: Pilot[Any], link: ScriptedLink) -> str:
    """Have everything be painted and half a second pass, so that a question takes answers."""
    await shown(app, pilot)
    await app.workers.wait_for_complete()
    await shown(app, pilot)
    link.now_s += 1.0
    return await shown(app, pilot)


def answers(link: ScriptedLink) -> list[tuple[str, str]]:
    return [(request["prompt"], request["text"]) for request in link.asked if request["op"] == "answer"]


def ops(link: ScriptedLink) -> list[str]:
    return [str(request["op"]) for request in link.asked]


@pytest.mark.parametrize("size", SIZES)
async def test_a_measurement_under_way(size: tuple[int, int]) -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=size) as pilot:
        measure(link)
        compare(f"run-measuring-{size[0]}x{size[1]}", await settled(app, pilot, link))
        assert work_of(app).done == [("run", "open-loop", "--dry-run", "--json")]


@pytest.mark.parametrize("size", SIZES)
async def test_a_question_before_a_motion(size: tuple[int, int]) -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=size) as pilot:
        measure(link)
        ask(link, **MOTION)
        text = await settled(app, pilot, link)
        assert "J1 -6.67°, J2 11.67°, J3 50.0 mm, J4 2.76°" in text
        assert "20 % override" in text
        compare(f"run-motion-{size[0]}x{size[1]}", text)


@pytest.mark.parametrize("size", SIZES)
async def test_the_end_of_a_run(size: tuple[int, int]) -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=size) as pilot:
        measure(link)
        end(link, "stopped", "Ada stopped the run")
        compare(f"run-stopped-{size[0]}x{size[1]}", await settled(app, pilot, link))


async def test_nothing_runs() -> None:
    link = ScriptedLink()
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        compare("run-nothing-80x24", await shown(app, pilot))


@pytest.mark.parametrize("size", [(100, 30), (60, 20), (200, 60), (40, 12)])
async def test_other_sizes_do_not_crash(size: tuple[int, int]) -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=size) as pilot:
        measure(link)
        ask(link, **MOTION)
        text = await settled(app, pilot, link)
        assert "F8" in text or size[1] < 20


async def test_motion_is_confirmed_by_f8_alone() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, **MOTION)
        await settled(app, pilot, link)
        await pilot.press("enter", "y", "space", "1", "escape")
        text = await shown(app, pilot)
        assert answers(link) == []
        assert "F8 confirms it" in text
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert answers(link) == [("stage/1", "yes")]


async def test_motion_is_refused_by_n() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, **MOTION)
        await settled(app, pilot, link)
        await pilot.press("n")
        await settled(app, pilot, link)
        assert answers(link) == [("stage/1", "no")]


async def test_a_key_pressed_as_the_question_comes_answers_nothing() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, **MOTION)
        await shown(app, pilot)
        await pilot.press("f8", "n")
        await shown(app, pilot)
        assert answers(link) == []


async def test_a_key_pressed_before_the_question_was_seen_answers_nothing() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
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


async def test_a_question_that_waited_behind_another_screen_is_looked_at_before_it_is_answered() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, **MOTION)
        await settled(app, pilot, link)
        await pilot.press("f2")
        link.now_s += 60.0
        await shown(app, pilot)
        await pilot.press("f4", "f8")
        await shown(app, pilot)
        assert answers(link) == []
        link.now_s += 1.0
        await shown(app, pilot)
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert answers(link) == [("stage/1", "yes")]


async def test_the_palette_asks_for_f8_before_a_motion() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
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
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(200, 60)) as pilot:
        ask(link, **MOTION)
        text = await settled(app, pilot, link)
        keys = [key.key for key in app.screen.query(FooterKey)]
        assert "o" in keys
        assert "f8" not in keys
        for y, line in enumerate(text.splitlines()):
            if "F8" in line:
                await pilot.click(offset=(line.index("F8") + 1, y))
        await settled(app, pilot, link)
        assert answers(link) == []
        screen = app.screen
        assert isinstance(screen, RunScreen)
        screen.action_ask_to_move()
        await shown(app, pilot)
        assert "f8" not in [key.key for key in app.screen.query(FooterKey)]


@pytest.mark.parametrize(
    ("safe", "keys", "answer"),
    [(None, ["y"], "yes"), (None, ["n"], "no"), ("yes", ["enter"], "yes"), (None, ["enter"], "no")],
)
async def test_a_confirmation_has_its_safe_answer_in_focus(
    safe: str | None, keys: list[str], answer: str
) -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, id="place/P1", kind="confirm", text="Put it there.", safe_answer=safe)
        await settled(app, pilot, link)
        focused = app.focused
        assert isinstance(focused, Button)
        assert focused.name == (safe or "no")
        await pilot.press("f8")
        await shown(app, pilot)
        assert answers(link) == []
        await pilot.press(*keys)
        await settled(app, pilot, link)
        assert answers(link) == [("place/P1", answer)]


async def test_choices_are_taken_by_their_numbers() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, id="beam/1", kind="choice", text="Which?", choices=["retry", "skip", "stop"])
        text = await settled(app, pilot, link)
        assert "1  retry" in text
        await pilot.press("enter", "9", "y", "n")
        await shown(app, pilot)
        assert answers(link) == []
        await pilot.press("2")
        await settled(app, pilot, link)
        assert answers(link) == [("beam/1", "skip")]


async def test_the_choice_that_moves_the_arm_takes_f8() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(
            link,
            id="beam/1",
            kind="choice",
            text="Which?",
            choices=["retry", "stop"],
            motion=True,
            safe_answer="stop",
        )
        await settled(app, pilot, link)
        await pilot.press("1")
        assert "F8 confirms it" in await shown(app, pilot)
        assert answers(link) == []
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert answers(link) == [("beam/1", "retry")]


async def test_a_number_is_checked_as_it_is_typed() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, id="height", kind="number", text="How high is it?", unit="mm")
        text = await settled(app, pilot, link)
        assert isinstance(app.focused, Input)
        assert " mm" in text
        await pilot.press("enter", "1", "x")
        assert "'1x' is no number in mm" in await shown(app, pilot)
        await pilot.press("enter")
        await shown(app, pilot)
        assert answers(link) == []
        await pilot.press("backspace", "full_stop", "5", "enter")
        await settled(app, pilot, link)
        assert answers(link) == [("height", "1.5")]


@pytest.mark.parametrize("kind", ["number", "text"])
async def test_stop_and_hold_from_within_an_input(kind: str) -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, id="a", kind=kind, text="What?")
        await settled(app, pilot, link)
        await pilot.press("h", "o", "n", "f12", "ctrl+c")
        await shown(app, pilot)
        assert ops(link) == ["stop", "hold"]
        assert isinstance(app.focused, Input)
        assert app.focused.value == "hon"


async def test_a_text_is_answered_with_enter_and_never_empty() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, id="jog/P1", kind="text", text="Type degrees, here or skip.", unit="deg")
        await settled(app, pilot, link)
        await pilot.press("enter")
        assert "type a line of text in deg" in await shown(app, pilot)
        await pilot.press(*"here", "enter")
        await settled(app, pilot, link)
        assert answers(link) == [("jog/P1", "here")]


async def test_a_refused_answer_is_told_beside_the_question() -> None:
    link = ScriptedLink(SNAPSHOT)
    link.refusals["answer"] = "'here' is no answer to 'jog/P1': type a number"
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, id="jog/P1", kind="text", text="Type it.")
        await settled(app, pilot, link)
        await pilot.press(*"here", "enter")
        text = await settled(app, pilot, link)
        assert "✗ 'here' is no answer" in text
        assert "Type it." in text
        await pilot.press("x")
        assert "✗" not in await shown(app, pilot)


async def test_a_question_that_is_withdrawn_while_somebody_types_is_gone() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, id="height", kind="number", text="How high is it?", unit="mm")
        await settled(app, pilot, link)
        await pilot.press("1", "2")
        tell(link, "answer", id="height", answer="3", who="Bob (attach-2)")
        text = await settled(app, pilot, link)
        assert "How high" not in text
        await pilot.press("enter", "y")
        await shown(app, pilot)
        assert answers(link) == []
        assert not app.screen.query("#prompt Input")


async def test_a_question_is_seen_from_every_screen_and_has_the_focus_when_it_is_shown() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
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


async def test_the_time_to_answer_counts_down() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, id="a", kind="choice", text="Which?", choices=["x", "y"], timeout_s=60.0, safe_answer="y")
        assert "59 s left, then y" in await settled(app, pilot, link)
        link.now_s += 30.0
        assert "29 s left, then y" in await shown(app, pilot)


async def test_control_is_taken_before_an_answer_when_nobody_has_it() -> None:
    link = ScriptedLink({**SNAPSHOT, "control": None})
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, **MOTION)
        await settled(app, pilot, link)
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert ops(link) == ["control", "answer"]


async def test_somebody_elses_control_is_named_and_can_be_taken() -> None:
    link = ScriptedLink({**SNAPSHOT, "control": {"client": "attach-2", "who": "Bob"}})
    app = app_of(link)
    async with app.run_test(size=(120, 40)) as pilot:
        ask(link, **MOTION)
        text = await settled(app, pilot, link)
        assert "Bob (attach-2) answers; c takes control" in text
        await pilot.press("c")
        await settled(app, pilot, link)
        assert link.asked == [{"op": "control", "take": True, "force": True}]
        await pilot.press("c")
        await shown(app, pilot)
        assert ops(link) == ["control", "release"]


async def test_the_override_is_lowered_by_a_number() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        link.tell("bench", **BENCH)
        await shown(app, pilot)
        await pilot.press("o")
        assert isinstance(app.screen, OverrideDialog)
        assert "It is 10 %" in await shown(app, pilot)
        await pilot.press("0", "enter")
        assert "from 1 to 100" in await shown(app, pilot)
        await pilot.press("f12")
        assert ops(link) == ["stop"]
        await pilot.press("backspace", "5", "enter")
        await shown(app, pilot)
        assert link.asked[-1] == {"op": "override", "percent": 5.0}
        await pilot.press("o", "escape")
        await shown(app, pilot)
        assert ops(link) == ["stop", "override"]


async def test_plots_log_levels_and_steps_by_keys() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        measure(link)
        text = await settled(app, pilot, link)
        assert "Innovation / µm" in text
        assert "× 1 of 3 outside" in text
        await pilot.press("v")
        text = await shown(app, pilot)
        assert "Δθ1 13.3 ●  Δθ2 6.7 ○" in text
        await pilot.press("w")
        text = await shown(app, pilot)
        assert "Log: warning and worse" in text
        assert "31 µm" in text
        await pilot.press("w")
        assert "31 µm" not in await shown(app, pilot)
        await pilot.press("w", "l")
        assert "Steps" not in await shown(app, pilot)
        await pilot.press("l")
        assert "Steps" in await shown(app, pilot)


async def test_the_list_of_steps_can_be_moved_back_and_forth() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        for number in range(60):
            tell(link, "step-done", step=f"s{number}", title=f"step {number:02d}", stored=False)
        text = await settled(app, pilot, link)
        assert "step 59" in text
        assert "step 20" not in text
        await pilot.press("pageup", "pageup", "pageup")
        text = await shown(app, pilot)
        assert "step 59" not in text
        await pilot.press("pagedown", "pagedown", "pagedown")
        assert "step 59" in await shown(app, pilot)


async def test_an_old_value_is_told_with_its_age_and_outside_with_a_word() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        show_value(link, "signal", 0.05, 0.6, 1.0, "")
        text = await shown(app, pilot)
        assert "OUT" in text
        assert "0.6 … 1" in text
        assert "old" not in text
        link.now_s += 9.0
        assert "(9.0 s old)" in await shown(app, pilot)


async def test_updates_that_did_not_come_are_told() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(120, 40)) as pilot:
        tell(link, "dropped", count=12)
        assert "12 updates skipped here, all are in the record" in await shown(app, pilot)


async def test_a_held_run_says_how_it_goes_on() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        tell(link, "state", state="HELD", reason="Ada holds the run")
        text = await shown(app, pilot)
        assert "Press g to go on" in text
        assert "GO ON g" in text
        await pilot.press("g")
        await shown(app, pilot)
        assert ops(link) == ["unhold"]
        await pilot.press("h")
        await shown(app, pilot)
        assert ops(link) == ["unhold", "hold"]


async def test_a_complete_measurement_is_identified_and_reported_by_keys(tmp_path: Path) -> None:
    link = ScriptedLink(SNAPSHOT)
    (tmp_path / "result-abc123.json").write_text("somebody's")
    app = make_app(link, "run", root=tmp_path / "runs")
    work_of(app).outcomes["report"] = Done((), 2, "", "catseye: the disk is full: make room")
    async with app.run_test(size=(80, 24), notifications=True) as pilot:
        end(link, "complete")
        text = await settled(app, pilot, link)
        assert "COMPLETE" in text
        await pilot.press("i")
        text = await settled(app, pilot, link)
        # Beside the folder of runs, under a name that is free.
        result = tmp_path / "result-abc123-2.json"
        assert work_of(app).done == [("identify", RUN, "--runs", str(tmp_path / "runs"), "-o", str(result))]
        await pilot.press("p")
        text = await settled(app, pilot, link)
        assert isinstance(app.screen, ErrorDialog)
        assert "the disk is full" in text
        await pilot.press("escape", "e")
        assert "resume: not now" in await settled(app, pilot, link)


async def test_an_interrupted_run_goes_on_after_f8() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        link.tell("bench", **BENCH)
        end(link, "stopped", "Ada stopped the run")
        await settled(app, pilot, link)
        await pilot.press("e")
        await shown(app, pilot)
        assert isinstance(app.screen, StartDialog)
        await pilot.press("enter")
        await shown(app, pilot)
        assert ops(link) == []
        await pilot.press("f8")
        await shown(app, pilot)
        assert link.asked == [{"op": "resume", "run": RUN, "arm": None}]


async def test_an_aborted_run_is_cleared_by_a_key() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        end(link, "aborted", "emergency stop")
        await settled(app, pilot, link)
        await pilot.press("x")
        await shown(app, pilot)
        assert ops(link) == ["clear"]


async def test_every_action_stands_in_the_palette() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)):
        named = {command.title for command in app.get_system_commands(app.screen)}
        assert {"Answer: yes", "Answer: no", "Lower the speed override", "After the run: resume"} <= named


async def test_nothing_of_the_run_before_stays_on_the_plots() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(120, 40)) as pilot:
        measure(link)
        before = await settled(app, pilot, link)
        assert "× 1 of 3 outside" in before
        assert "Innovation / µm" in before
        assert "Δθ1 13.3" in before
        end(link, "complete")
        link.tell("run-started", procedure="warmup", title="Warm-up", run="20261121T110000Z_warmup_00beef")
        after = await settled(app, pilot, link)
        assert "outside" not in after
        assert "µm" not in after
        assert "Δθ1" not in after
        assert "nothing yet" in after


async def test_the_time_to_answer_and_the_clock_are_those_of_the_run_not_of_this_program() -> None:
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
    link = ScriptedLink({**SNAPSHOT, "simulated": True, "prompt": question, "prompt_open_s": 15.0})
    app = app_of(link)
    async with app.run_test(size=(120, 40)) as pilot:
        run = link.picture.run
        assert run is not None
        measure(link)
        run.take_record(SoFar([], [], 0, [], [], speed=20.0))
        text = await settled(app, pilot, link)
        # 1200 bench seconds are a minute here; 15 s of it had passed before this client came, and one since.
        assert "44 s left, then y" in text
        assert "bench time" in text


async def test_a_long_reason_leaves_the_line_about_the_bench_where_it_is() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        link.tell("bench", **BENCH)
        tell(
            link,
            "state",
            state="ABORTING",
            reason="the drives are off: find out why before switching them on " * 3,
        )
        lines = (await shown(app, pilot)).splitlines()
        assert "ABORTING" in lines[0]
        assert lines[0].endswith("…")
        assert "disk" in lines[1]
        assert "F2 Bench" in lines[2]


async def test_nobody_is_told_to_answer_while_the_run_is_being_stopped() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, **MOTION)
        assert "Answer the question" in await settled(app, pilot, link)
        tell(link, "state", state="STOPPING", reason="Ada stops the run")
        text = await shown(app, pilot)
        assert "Answer the question" not in text
        assert "Wait for standstill: Ada stops the run" in text


async def test_every_choice_but_the_safe_one_takes_f8_where_the_arm_moves_after_it() -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        choices = ["retry", "skip", "stop"]
        ask(link, id="beam/1", kind="choice", text="?", choices=choices, motion=True, safe_answer="stop")
        text = await settled(app, pilot, link)
        assert [button.name for button in app.screen.query("#answers Button").results(Button)] == ["stop"]
        assert "2 F8  skip: the arm moves" in text
        await pilot.press("2")
        assert "the arm moves after skip: F8 confirms it" in await shown(app, pilot)
        assert answers(link) == []
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert answers(link) == [("beam/1", "skip")]
        ask(link, id="beam/2", kind="choice", text="?", choices=choices, motion=True, safe_answer="stop")
        await settled(app, pilot, link)
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert answers(link)[1:] == [("beam/2", "retry")]


@pytest.mark.parametrize("kind", ["text", "number"])
async def test_what_is_typed_moves_the_arm_by_f8_not_by_enter(kind: str) -> None:
    link = ScriptedLink(SNAPSHOT)
    app = app_of(link)
    async with app.run_test(size=(80, 24)) as pilot:
        ask(link, id="jog/P1", kind=kind, text="By how much?", unit="deg", safe_answer="skip", motion=True)
        assert "THE ARM MOVES then, as the answer says" in await settled(app, pilot, link)
        await pilot.press("f8")
        assert "✗ type a" in await shown(app, pilot)
        await pilot.press("1", "enter")
        assert "the arm moves after 1: F8 confirms it" in await shown(app, pilot)
        await settled(app, pilot, link)
        assert answers(link) == []
        await pilot.press("f8")
        await settled(app, pilot, link)
        assert answers(link) == [("jog/P1", "1")]
