"""Which value a technician watches now, and what is said of it."""

import pytest

from catseye.app.protocol.run_events import LiveData
from catseye.app.tui.run_state import RunState
from catseye.procedures.kit.live import Live
from catseye.procedures.scara.alignment.beam_to_j4 import stage_screw
from tests.unit.app.tui.screens.run_screen import run_screen, settled
from tests.unit.app.tui.scripted import ScriptedLink, changed_screen, shown
from tests.unit.app.tui.scripted_bench import BENCH
from tests.unit.app.tui.scripted_run import MOTION, ask, measure, publish, show_value
from tests.unit.procedures.mounts import mounted_bench

SIZES = [(80, 24), (120, 40)]

CLEAR = {**MOTION, "id": "beam/1", "text": "Clear the beam to P1.", "task": {"do": "clear-beam"}}


def run_with(*values: Live) -> RunState:
    run = RunState("run", "open-loop", "Measurement", 0.0)
    for value in values:
        run.take_live(LiveData.of(value), 1.0)
    return run


def test_a_judged_value_goes_before_one_without_a_band() -> None:
    run = run_with(Live("signal", 0.4, "", 0.1, 1.0), Live("J4", -123.4, "deg"))
    assert run.watched is not None
    assert run.watched.data.name == "signal"


def test_a_judged_value_outlasts_others_between_steps() -> None:
    run = RunState("r", "reflector-search", "Search", 0.0)
    for value in (Live("signal", 0.9, "", 0.1, 1.0), Live("J4", 12.0, "deg")):
        run.take_live(LiveData.of(value), 1.0)
    run.begin_phase()
    assert run.watched is not None
    assert run.watched.data.name == "signal"


def test_what_was_shown_before_the_question_is_not_watched() -> None:
    run = run_with(Live("innovation", 3.0, "µm", -9.0, 9.0))
    run.begin_phase()
    run.take_live(LiveData.of(Live("J4", 12.0, "deg")), 2.0)
    assert run.watched is not None
    assert run.watched.data.name == "J4"


def test_the_peak_is_held_from_the_question_on() -> None:
    signal = (Live("signal", value, "", 0.1, 1.0) for value in (0.99, 0.2, 0.7, 0.05))
    run = run_with(next(signal))
    run.begin_phase()
    for each in signal:
        run.take_live(LiveData.of(each), 2.0)
    watched = run.watched
    assert watched is not None
    assert (watched.peak, watched.was_out, watched.data.value) == (0.7, True, 0.05)


@pytest.mark.parametrize("size", SIZES)
async def test_a_returning_beam_names_the_key_that_answers(size: tuple[int, int]) -> None:
    async with run_screen(size=size) as (app, pilot, link):
        measure(link)
        ask(link, **CLEAR)
        for value in (0.02, 0.95, 0.81):
            show_value(link, "signal", value, 0.1, 1.0, "")
        text = await settled(app, pilot, link)
        show_value(link, "signal", 0.81, 0.1, 1.0, "")
        text = await shown(app, pilot)
        assert "the signal is back: F8" in text
        assert "peak 0.950" in text
        assert not changed_screen(f"run-beam-back-{size[0]}x{size[1]}", text)


async def test_a_beam_that_is_away_promises_no_key() -> None:
    async with run_screen(size=(120, 40)) as (app, pilot, link):
        ask(link, **CLEAR)
        for value in (0.95, 0.02):
            show_value(link, "signal", value, 0.1, 1.0, "")
        text = await settled(app, pilot, link)
        assert "OUT" in text
        assert "is back" not in text


def beam(link: ScriptedLink, signal: float, *, beam_ok: bool) -> None:
    link.publish("bench", **{**BENCH, "beam": {**BENCH["beam"], "signal": signal, "beam_ok": beam_ok}})


async def test_a_task_at_the_beam_shows_the_signal() -> None:
    async with run_screen(size=(120, 40)) as (app, pilot, link):
        measure(link)
        ask(link, **CLEAR)
        beam(link, 0.03, beam_ok=False)
        text = await settled(app, pilot, link)
        assert "NO BEAM" in text.partition("signal")[2]
        assert "innovation / µm" not in text
        beam(link, 0.88, beam_ok=True)
        text = await shown(app, pilot)
        assert "the signal is back: F8" in text
        assert "peak 0.880" in text


async def test_a_question_without_a_value_shows_no_older_one() -> None:
    async with run_screen(size=(120, 40)) as (app, pilot, link):
        measure(link)
        ask(link, **MOTION)
        text = await settled(app, pilot, link)
        assert "innovation / µm" not in text
        assert "nothing is watched now" in text


async def test_after_the_answer_the_value_of_the_run_is_back() -> None:
    async with run_screen(size=(120, 40)) as (app, pilot, link):
        measure(link)
        ask(link, **CLEAR)
        publish(link, "answer", id="beam/1", answer="yes", who="Ada")
        assert "innovation / µm" in await settled(app, pilot, link)


@pytest.mark.parametrize("size", SIZES)
async def test_whoever_turns_a_screw_sees_the_turns(size: tuple[int, int]) -> None:
    asked = stage_screw(mounted_bench()).while_turned(-0.29, 0.42)
    async with run_screen(size=size) as (app, pilot, link):
        ask(link, **MOTION)
        publish(link, "live", state="EXECUTE", data=LiveData.of(asked).json_object())
        text = await settled(app, pilot, link)
    assert "stage screw, turns to make / turns" in text
    assert "anticlockwise; count" in text
    assert "(42%) tells" in text
    assert "peak" not in text


def test_a_screw_beyond_its_tolerance_with_u_is_out() -> None:
    # 0.09 mm lies within ±0.1 mm, 0.09 mm ± 0.04 mm does not, and the procedure has it turned again.
    live = Live("offset", 0.09, "mm", -0.1, 0.1, "turn", expanded=0.04)
    assert not LiveData.of(live).accepted
    assert LiveData.of(Live("offset", 0.05, "mm", -0.1, 0.1, expanded=0.04)).accepted


async def test_the_uncertainty_that_is_judged_with_stands_there() -> None:
    async with run_screen() as (app, pilot, link):
        measure(link)
        live = LiveData.of(Live("offset", 0.09, "mm", -0.1, 0.1, "turn", expanded=0.04))
        publish(link, "live", state="EXECUTE", data=live.json_object())
        text = await settled(app, pilot, link)
        assert "OUT  ±0.1 mm, U 0.040" in text
