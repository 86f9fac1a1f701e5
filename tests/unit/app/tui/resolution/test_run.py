"""The screen Run while an arm is stepped: the staircase so far, the errors of its steps, what never came."""

import math

import pytest

from catseye.app.protocol.run_events import LiveData
from catseye.app.tui.run_state import RunState
from catseye.procedures.kit.live import Live, LiveStep
from tests.unit.app.tui.screens.run_screen import run_screen
from tests.unit.app.tui.scripted import ScriptedLink, changed_screen, shown
from tests.unit.app.tui.scripted_run import RUN, SNAPSHOT, publish

SIZES = [(80, 24), (120, 40), (160, 50)]
RATIO = 1.072267
"""From step to step (resolution paper, section 3.4)."""

STEPPING = {**SNAPSHOT, "procedure": "resolution", "title": "Motion resolution of joints"}


def step(
    number: int, series: str = "A1+ at K1", torque_nm: float | None = -12.3, resolved: float = 0.0
) -> LiveStep:
    """Return a step whose error grows as it shrinks, and changes its sign."""
    command = 0.1 / RATIO ** (number - 1)
    error = 100.0 * 2e-4 / command * math.cos(number)
    measured = command * (1.0 + error / 100.0)
    position = 1.5 - 15.0 * command
    return LiveStep(
        series, number, 109, command, measured, position, "deg", error, 10.0, torque_nm, command < resolved
    )


def show_step(link: ScriptedLink, made: LiveStep) -> None:
    live = Live("step error", made.error_percent, "%", -10.0, 10.0, step=made)
    publish(link, "live", state="EXECUTE", data=LiveData.of(live).json_object())


@pytest.mark.parametrize("size", SIZES)
async def test_the_staircase_and_its_errors_are_drawn(size: tuple[int, int]) -> None:
    async with run_screen(STEPPING, size=size) as (app, pilot, link):
        publish(link, "step-started", step="A1/K1/+", title="A1+ at K1", attempt=1)
        for number in range(1, 90):
            show_step(link, step(number, resolved=4e-4))
        await shown(app, pilot)
        assert not changed_screen(f"run-steps-{size[0]}x{size[1]}", await shown(app, pilot))
        await pilot.press("v")
        text = await shown(app, pilot)
        assert "Step errors / %, band ±10, mean ± σ" in text
        assert "Innovation" not in text


async def test_nothing_is_drawn_before_the_first_step() -> None:
    async with run_screen(STEPPING, size=(120, 40)) as (app, pilot, _):
        text = await shown(app, pilot)
        assert text.count("no step yet: the series begins with a standstill") == 2
        assert "maps" not in text


async def test_errors_are_counted_by_what_they_say() -> None:
    async with run_screen(STEPPING, size=(160, 50)) as (app, pilot, link):
        made = [step(number, resolved=3e-4) for number in range(1, 110)]
        for each in made:
            show_step(link, each)
        text = await shown(app, pilot)
        outside = sum(abs(each.error_percent) > 10.0 and each.command >= 3e-4 for each in made)
        below = sum(each.command < 3e-4 for each in made)
        beyond = sum(abs(each.error_percent) > 60.0 for each in made)
        counts = f"× {outside} of {109 - below} outside, {below} below the instrument, {beyond} beyond ±60 %"
        assert counts in text
        assert "┈┈ below the instrument" in text


async def test_equal_steps_are_drawn_one_after_the_other() -> None:
    async with run_screen(STEPPING, size=(120, 40)) as (app, pilot, link):
        for number in range(1, 21):
            command = 0.01 if number <= 10 else -0.01
            made = LiveStep("A1 at K1", number, 30, command, command, 0.0, "deg", 5.0, 10.0)
            show_step(link, made)
        text = await shown(app, pilot)
        assert "mean ± σ" not in text
        assert "commanded step" not in text
        assert {"▲", "▼"} <= set(text)


def state_after(*steps: LiveStep) -> RunState:
    run = RunState(RUN, "resolution", "", 0.0)
    for made in steps:
        live = Live("step error", made.error_percent, "%", step=made)
        run.take_live(LiveData.of(live), 0.0)
    return run


def test_another_series_begins_another_staircase() -> None:
    run = state_after(step(1), step(2), step(1, "A1− at K1"))
    assert [(made.series, made.number) for made in run.staircase] == [("A1− at K1", 1)]


def test_a_series_recorded_anew_begins_another_staircase() -> None:
    assert [made.number for made in state_after(step(1), step(2), step(3), step(1)).staircase] == [1]


async def test_a_client_that_came_late_draws_what_it_saw() -> None:
    async with run_screen(STEPPING, size=(120, 40)) as (app, pilot, link):
        for number in (40, 41):
            show_step(link, step(number, torque_nm=None))
        text = await shown(app, pilot)
        assert "Staircase A1+ at K1, steps 40 to 41" in text
        assert "N m" not in text
