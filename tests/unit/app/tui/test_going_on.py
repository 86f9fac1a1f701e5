"""Letting a held run go on: the same key as for every motion, after what moves was said."""

import pytest

from catseye.app.protocol.rehearsal import Rehearsal
from catseye.app.tui.dialogs.questions import MotionDialog
from catseye.app.tui.going_on import going_on_lines
from tests.unit.app.tui.scripted import ScriptedLink, changed_screen, shown, started
from tests.unit.app.tui.scripted_bench import bench
from tests.unit.app.tui.scripted_run import MOTION, REHEARSAL, RUN, SNAPSHOT, ask, publish

SPEEDS = (420.0, 720.0, 1100.0, 3000.0)


def hold(link: ScriptedLink, reason: str = "at a checkpoint: Ada holds the run") -> None:
    publish(link, "state", state="HELD", reason=reason)


def rehearse(link: ScriptedLink) -> None:
    """Put the arm before the second of eight commands of a rehearsed run."""
    run = link.engine.run
    assert run is not None
    run.rehearsal = Rehearsal.model_validate_json(REHEARSAL.out)
    publish(link, "step-done", step="P1/0000", title="P1: first", stored=False)
    axes = [{**axis, "speed": speed} for axis, speed in zip(bench()["axes"], SPEEDS, strict=True)]
    link.publish("bench", **bench(axes=axes))


@pytest.mark.parametrize(
    "screen", ["bench", "run", "jog", "terminal", "procedures", "results", "runs", "setup"]
)
async def test_f8_asks_on_every_screen_and_f8_there_releases(screen: str) -> None:
    async with started(SNAPSHOT, screen) as (app, pilot, link):
        hold(link)
        await shown(app, pilot)
        await pilot.press("f8")
        assert "goes on where it was held" in await shown(app, pilot)
        assert "unhold" not in link.ops
        link.now_s += 2.0
        await pilot.press("f8")
        await shown(app, pilot)
        assert link.ops[-1] == "unhold"


@pytest.mark.parametrize(
    ("case", "why"),
    [
        ("before", "not known: this run is not rehearsed yet; Run (F4) rehearses it"),
        ("unknown", "not known: how to rehearse this run is not known"),
        ("beyond", "not known: the rehearsal has no motion from this step on"),
    ],
)
async def test_a_target_that_is_not_known_says_why(case: str, why: str) -> None:
    async with started(SNAPSHOT, "bench") as (_, _, link):
        publish(link, "step-started", step="P9/0009", title="P9: command 9", attempt=1)
        run = link.engine.run
        assert run is not None
        run.command = () if case == "unknown" else ("run", "open-loop", "--dry-run", "--json")
        if case == "beyond":
            run.rehearsal = Rehearsal.model_validate_json(REHEARSAL.out).model_copy(update={"steps": ()})
        text = " ".join(" ".join(going_on_lines(link.engine, run, link.now_s)).split())
        assert "step P9: command 9" in text
        assert why in text


async def test_g_releases_nothing() -> None:
    async with started(SNAPSHOT, "run") as (app, pilot, link):
        hold(link)
        await shown(app, pilot)
        await pilot.press("g")
        await shown(app, pilot)
        assert not isinstance(app.screen, MotionDialog)
        assert "unhold" not in link.ops


@pytest.mark.parametrize("until_it_repeats_s", [0.033, 0.25, 0.5, 0.66, 1.0])
async def test_f8_held_down_releases_nothing(until_it_repeats_s: float) -> None:
    async with started(SNAPSHOT, "run") as (app, pilot, link):
        hold(link)
        await shown(app, pilot)
        await pilot.press("f8")
        link.now_s += until_it_repeats_s
        for _ in range(60):
            await pilot.press("f8")
            link.now_s += 0.033
        assert "then press F8 once" in await shown(app, pilot)
        assert "unhold" not in link.ops
        link.now_s += 1.2
        await pilot.press("f8")
        await shown(app, pilot)
        assert link.ops[-1] == "unhold"


async def test_another_hold_than_the_one_read_is_not_released() -> None:
    async with started(SNAPSHOT, "run") as (app, pilot, link):
        for anew, why in (
            ("held", "the run has been held again"),
            ("executed", "the run is not held any more"),
        ):
            hold(link)
            await shown(app, pilot)
            await pilot.press("f8")
            publish(link, "state", state="EXECUTE", reason="Ben lets the run go on")
            if anew == "held":
                # The same person, with the same words.
                hold(link)
            link.now_s += 2.0
            await pilot.press("f8")
            assert why in await shown(app, pilot)
            assert "unhold" not in link.ops
            await pilot.press("escape")


async def test_another_override_than_the_one_read_releases_nothing() -> None:
    async with started(SNAPSHOT, "run") as (app, pilot, link):
        rehearse(link)
        hold(link)
        await shown(app, pilot)
        await pilot.press("f8")
        robot = bench()["robot"]
        link.publish("bench", **bench(robot={**robot, "override_percent": robot["override_percent"] + 5.0}))
        link.now_s += 2.0
        await pilot.press("f8")
        assert "the override has changed" in await shown(app, pilot)
        assert "unhold" not in link.ops


async def test_f8_answers_the_open_question_while_a_hold_waits() -> None:
    async with started(SNAPSHOT, "run") as (app, pilot, link):
        ask(link, **MOTION)
        publish(link, "state", state="HOLDING", reason="Ada holds the run")
        await shown(app, pilot)
        await app.workers.wait_for_complete()
        await shown(app, pilot)
        link.now_s += 2.0
        await shown(app, pilot)
        await pilot.press("f8")
        await shown(app, pilot)
        assert "answer" in link.ops
        assert not isinstance(app.screen, MotionDialog)


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_the_next_target_is_said_with_distance_and_time(size: tuple[int, int]) -> None:
    async with started(SNAPSHOT, "run", size=size) as (app, pilot, link):
        rehearse(link)
        hold(link)
        await shown(app, pilot)
        await pilot.press("f8")
        text = await shown(app, pilot)
        assert f"{RUN} goes on" in text
        # J1 turns by 150° at a tenth of 420 deg/s; the J4 axis goes from (344.5, 332.7) mm at (20°, 60°) to 550 mm at
        # -130°, where the step's first motion ends.
        assert "J1 by 150.00°" in text
        assert "3.6 s" in text
        assert "1027.5 mm in x and y" in text
        assert "x -353.5 mm, y -421.3 mm" in text
        assert "8 points" in text
        assert not changed_screen(f"run-go-on-{size[0]}x{size[1]}", text)
