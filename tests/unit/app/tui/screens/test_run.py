"""The run screen: what it shows, and every key of it but those of questions."""

from pathlib import Path
from typing import Any

import pytest

from catseye.app.protocol.engine_events import Client
from catseye.app.protocol.requests import Override, Resume
from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from catseye.app.tui.dialogs.override_dialog import OverrideDialog
from catseye.app.tui.dialogs.start_dialog import StartDialog
from tests.unit.app.tui.screens.run_screen import ops, run_screen, settled
from tests.unit.app.tui.scripted import ScriptedLink, changed_screen, failed, make_app, shown, work_of
from tests.unit.app.tui.scripted_bench import BENCH
from tests.unit.app.tui.scripted_run import RUN, SNAPSHOT, end, measure, publish, show_value
from tests.unit.app.tui.serial.scripted_arm import arm_bench

SIZES = [(80, 24), (120, 40)]


@pytest.mark.parametrize("size", SIZES)
async def test_a_measurement_under_way(size: tuple[int, int]) -> None:
    async with run_screen(size=size) as (app, pilot, link):
        measure(link)
        assert not changed_screen(f"run-measuring-{size[0]}x{size[1]}", await settled(app, pilot, link))
        assert work_of(app).done == [("run", "open-loop", "--dry-run", "--json")]


async def test_pictures_have_the_room_of_values_that_nobody_watches() -> None:
    async with run_screen(size=(120, 40)) as (app, pilot, link):
        publish(link, "step-started", step="P1", title="visit 1", attempt=1)
        publish(link, "step-done", step="P1", title="visit 1", stored=True)
        assert "nothing is watched now" not in await settled(app, pilot, link)
        show_value(link, "signal", 0.7, 0.1, 1.0, "")
        assert "─ signal ─" in await settled(app, pilot, link)


@pytest.mark.parametrize("size", SIZES)
async def test_the_end_of_a_run(size: tuple[int, int]) -> None:
    async with run_screen(size=size) as (app, pilot, link):
        measure(link)
        end(link, "stopped", "Ada stopped the run")
        assert not changed_screen(f"run-stopped-{size[0]}x{size[1]}", await settled(app, pilot, link))


async def test_the_override_is_lowered_by_a_number() -> None:
    async with run_screen() as (app, pilot, link):
        link.publish("bench", **BENCH)
        await shown(app, pilot)
        await pilot.press("minus")
        assert isinstance(app.screen, OverrideDialog)
        assert "It is 10 %" in await shown(app, pilot)
        await pilot.press("0", "enter")
        assert "from 1 to 100" in await shown(app, pilot)
        await pilot.press("f12")
        assert ops(link) == ["stop"]
        await pilot.press("backspace", "5", "enter")
        await shown(app, pilot)
        assert link.asked[-1] == Override(percent=5.0)
        await pilot.press("minus", "escape")
        await shown(app, pilot)
        assert ops(link) == ["stop", "override"]


async def test_plots_log_levels_and_steps_by_keys() -> None:
    async with run_screen() as (app, pilot, link):
        measure(link)
        text = await settled(app, pilot, link)
        assert "Steps" in text
        await pilot.press("v")
        text = await settled(app, pilot, link)
        assert "Steps" not in text
        assert "From the record" in text
        await pilot.press("v")
        assert "Steps" in await settled(app, pilot, link)
        await pilot.press("f")
        text = await shown(app, pilot)
        assert "Log: warning and worse" in text
        assert "31 µm" in text
        await pilot.press("f")
        assert "31 µm" not in await shown(app, pilot)
        await pilot.press("f", "l")
        assert "Steps" not in await shown(app, pilot)
        await pilot.press("l")
        assert "Steps" in await shown(app, pilot)


async def test_a_complete_measurement_is_identified_and_reported_by_keys(tmp_path: Path) -> None:
    link = ScriptedLink(SNAPSHOT)
    (tmp_path / "result-abc123.json").write_text("somebody's")
    app = make_app(link, "run", root=tmp_path / "runs")
    work_of(app).outcomes["report"] = failed(2, "the disk is full: make room")
    async with app.run_test(size=(80, 24), notifications=True) as pilot:
        end(link, "complete")
        text = await settled(app, pilot, link)
        assert "COMPLETE" in text
        await pilot.press("i")
        text = await settled(app, pilot, link)
        # Beside the folder of runs, under a name that is free.
        result = tmp_path / "result-abc123-2.json"
        assert work_of(app).done[1:] == [
            ("identify", RUN, "--runs", str(tmp_path / "runs"), "-o", str(result))
        ]
        await pilot.press("p")
        text = await settled(app, pilot, link)
        assert isinstance(app.screen, ErrorDialog)
        assert "the disk is full" in text
        await pilot.press("escape", "r")
        assert "resume: not now" in await settled(app, pilot, link)


async def test_nothing_of_the_run_before_stays_on_the_plots() -> None:
    async with run_screen(size=(120, 40)) as (app, pilot, link):
        measure(link)
        before = await settled(app, pilot, link)
        assert "× 1 of 3 outside" in before
        assert "Innovation / µm" in before
        assert f"{RUN} is not a run" in " ".join(before.replace("│", " ").split())
        end(link, "complete")
        link.publish(
            "run-started", procedure="open-loop", title="Open loop", run="20261121T110000Z_open-loop_00beef"
        )
        after = await settled(app, pilot, link)
        assert "outside" not in after
        assert "µm" not in after
        assert "nothing yet" in after
        assert "nothing measured yet" in after


async def test_what_the_engine_reports_beside_the_steps() -> None:
    async with run_screen() as (app, pilot, link):
        named = {command.title for command in app.get_system_commands(app.screen)}
        assert {"Answer: yes", "Answer: no", "Lower the speed override", "After the run: resume"} <= named
        show_value(link, "signal", 0.05, 0.6, 1.0, "")
        text = await shown(app, pilot)
        assert "OUT" in text
        assert "0.6 … 1" in text
        assert "old" not in text
        link.now_s += 9.0
        assert "(9.0 s old)" in await shown(app, pilot)
        for number in range(60):
            publish(link, "step-done", step=f"s{number}", title=f"step {number:02d}", stored=False)
        text = await settled(app, pilot, link)
        assert "step 59" in text
        assert "step 20" not in text
        await pilot.press("pageup", "pageup", "pageup")
        text = await shown(app, pilot)
        assert "step 59" not in text
        await pilot.press("pagedown", "pagedown", "pagedown")
        assert "step 59" in await shown(app, pilot)
        await pilot.resize_terminal(120, 40)
        publish(link, "dropped", count=12)
        assert "12 updates skipped here, all are in the record" in await shown(app, pilot)


async def test_held_runs_offer_going_on_and_long_reasons_are_truncated() -> None:
    async with run_screen() as (app, pilot, link):
        publish(link, "state", state="HELD", reason="Ada holds the run")
        text = await shown(app, pilot)
        assert "F8 continues it" in text
        assert "GO ON F8" in text
        await pilot.press("f8")
        await shown(app, pilot)
        link.now_s += 2.0
        await pilot.press("f8")
        await shown(app, pilot)
        assert ops(link) == ["unhold"]
        await pilot.press("h")
        await shown(app, pilot)
        assert ops(link) == ["unhold", "hold"]
        link.publish("bench", **BENCH)
        reason = "the drives are off: find out why before switching them on " * 3
        publish(link, "state", state="ABORTING", reason=reason)
        lines = (await shown(app, pilot)).splitlines()
        assert "ABORTING" in lines[0]
        assert lines[0].endswith("…")
        assert "disk" in lines[1]
        assert "F2 Bench" in lines[2]
        end(link, "aborted", "emergency stop")
        await settled(app, pilot, link)
        await pilot.press("x")
        await shown(app, pilot)
        assert ops(link) == ["unhold", "hold", "clear"]


@pytest.mark.parametrize(
    ("status", "shown_first"),
    [
        (BENCH, {"From the record"}),
        (arm_bench(), {"Staircase", "Step errors"}),
        (arm_bench(optics=None), {"From the record"}),
    ],
    ids=["scara", "resolution", "six axes"],
)
async def test_an_idle_screen_has_the_words_of_its_system(
    status: dict[str, Any], shown_first: set[str]
) -> None:
    words = {"Staircase", "Step errors", "From the record"}
    async with run_screen({}, size=(120, 40)) as (app, pilot, link):
        link.publish("bench", **status)
        text = await settled(app, pilot, link)
        assert {word for word in words if word in text} == shown_first


async def test_before_a_run_and_after_one_that_was_interrupted() -> None:
    async with run_screen({}) as (app, pilot, link):
        assert not changed_screen("run-nothing-80x24", await shown(app, pilot))
        link.engine.control = Client.model_validate(SNAPSHOT["control"])
        link.publish("run-started", procedure="open-loop", title=SNAPSHOT["title"], run=RUN)
        link.publish("bench", **BENCH)
        end(link, "stopped", "Ada stopped the run")
        await settled(app, pilot, link)
        await pilot.press("r")
        await shown(app, pilot)
        assert isinstance(app.screen, StartDialog)
        await pilot.press("enter")
        await shown(app, pilot)
        assert ops(link) == []
        await pilot.press("f8")
        await shown(app, pilot)
        assert link.asked == [Resume(run=RUN)]
