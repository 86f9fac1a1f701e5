"""How far a run is between two words of its engine."""

import pytest

from catseye.app.protocol.run_events import Progressed
from catseye.app.tui.run_pace import RunPace
from tests.unit.app.tui.screens.run_screen import run_screen, settled
from tests.unit.app.tui.scripted import shown
from tests.unit.app.tui.scripted_run import MOTION, ask, measure, publish, times_s


def progress(elapsed_s: float, remaining_s: float) -> Progressed:
    return Progressed(
        run="r",
        done=elapsed_s,
        total=elapsed_s + remaining_s,
        text="",
        **times_s(elapsed_s, remaining_s),
    )


def test_bench_time_goes_on_at_the_speed_of_the_bench() -> None:
    pace = RunPace()
    pace.take(progress(10.0, 90.0), 100.0)
    assert pace.since_s(103.0, 2.0) == 6.0


def test_a_wait_is_no_part_of_the_time() -> None:
    pace = RunPace()
    pace.take(progress(10.0, 90.0), 100.0)
    pace.stand(True, 102.0)
    assert pace.since_s(150.0, 1.0) == 2.0
    pace.stand(False, 160.0)
    assert pace.since_s(161.0, 1.0) == 3.0


@pytest.mark.parametrize(
    ("totals_s", "grown_s"),
    [((100.0, 90.0), 0.0), ((100.0, 103.0), 0.0), ((100.0, 120.0), 20.0), ((150.0, 100.0, 130.0), 30.0)],
)
def test_the_end_is_held_against_the_earliest_estimate(totals_s: tuple[float, ...], grown_s: float) -> None:
    pace = RunPace()
    for total_s in totals_s:
        pace.take(progress(10.0, total_s - 10.0), 0.0)
    assert pace.grown_s == grown_s


async def test_an_end_that_moves_away_says_so() -> None:
    async with run_screen(size=(120, 40)) as (app, pilot, link):
        measure(link)
        publish(
            link,
            "progress",
            done=5.0,
            total=50.0,
            text="P1",
            elapsed_bench_s=5.0,
            left_bench_s=45.7,
            elapsed_s=5.0,
            left_s=45.7,
        )
        # 50.7 s in all, after 10.7 s.
        assert "left 46 s, 40 s more than expected" in await shown(app, pilot)
        link.now_s += 10.0
        assert "left 36 s" in await shown(app, pilot)


async def test_a_run_that_asks_waits_for_you() -> None:
    async with run_screen(size=(120, 40)) as (app, pilot, link):
        measure(link)
        ask(link, **MOTION)
        link.now_s += 42.0
        text = await shown(app, pilot)
        assert "left 6.7 s" in text
        assert "waiting for you: 42 s" in text
        publish(link, "answer", id="stage/1", answer="yes", who="Ada")
        text = await shown(app, pilot)
        assert "left 6.7 s" in text
        assert "waiting" not in text


async def test_a_run_past_its_estimate_says_so() -> None:
    async with run_screen(size=(120, 40)) as (app, pilot, link):
        measure(link)
        link.now_s += 30.0
        assert "longer than estimated" in await settled(app, pilot, link)


async def test_a_held_run_does_not_count_down() -> None:
    async with run_screen(size=(120, 40)) as (app, pilot, link):
        measure(link)
        publish(link, "state", state="HELD", reason="Ada holds the run")
        link.now_s += 5.0
        assert "left 6.7 s" in await shown(app, pilot)
