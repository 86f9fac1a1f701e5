"""The time left is estimated from the pace of the run, whoever has kept it waiting."""

import asyncio
import itertools
import random

import pytest

from catseye.app.engine.control import RunControl
from catseye.app.engine.timekeeping import JUMP, Progress
from tests.unit.app.engine.fakes import ManualClock


def running(clock: ManualClock) -> RunControl:
    control = RunControl(clock, lambda _state, _reason: None)
    control.starting()
    control.started()
    return control


async def until_idle() -> None:
    for _ in range(20):
        await asyncio.sleep(0)


def test_waiting_at_a_question_does_not_slow_the_estimate() -> None:
    clock = ManualClock()
    progress = Progress(clock)
    progress.estimate(100.0, 300.0)
    clock.advance(20.0 + 3600.0)
    left = progress.estimate(110.0, 300.0, 3600.0)
    # Ten expected seconds took twenty; 50 more count as rehearsed.
    assert (left.elapsed_bench_s, left.elapsed_s) == (20.0, 3620.0)
    assert left.left_bench_s == pytest.approx(190.0 * 70.0 / 60.0)
    assert left.changed == "this part took 10 s more than expected"


def test_a_wait_before_the_first_estimate_counts_as_little() -> None:
    clock = ManualClock()
    progress = Progress(clock)
    clock.advance(1000.0)
    progress.estimate(100.0, 300.0, 1000.0)
    clock.advance(20.0)
    assert progress.estimate(110.0, 300.0, 1000.0).left_bench_s == pytest.approx(190.0 * 70.0 / 60.0)


def test_real_time_is_bench_time_by_the_speed() -> None:
    clock = ManualClock()
    progress = Progress(clock, speed=400.0)
    progress.estimate(0.0, 1000.0)
    clock.advance(100.0)
    left = progress.estimate(100.0, 1000.0)
    assert (left.elapsed_bench_s, left.left_bench_s) == (100.0, 900.0)
    assert (left.elapsed_s, left.left_s) == (0.25, 2.25)


@pytest.mark.parametrize("pace", [0.5, 1.0, 1.3, 1.6])
def test_a_rehearsed_run_estimates_without_jumps(pace: float) -> None:
    clock, drawn = ManualClock(), random.Random(20)
    progress, step_s, steps = Progress(clock), 7.0, 200
    words = [progress.estimate(0.0, steps * step_s)]
    for number in range(steps):
        clock.advance(pace * step_s * drawn.uniform(0.2, 1.8))
        words.append(progress.estimate((number + 1) * step_s, steps * step_s))
    totals_s = [word.elapsed_bench_s + word.left_bench_s for word in words]
    jumps = [abs(after - before) / before for before, after in itertools.pairwise(totals_s)]
    assert max(jumps) <= JUMP
    assert {word.changed for word in words} == {""}
    assert words[-1].left_bench_s == 0.0


def test_a_slow_first_step_does_not_multiply() -> None:
    clock = ManualClock()
    progress = Progress(clock)
    progress.estimate(0.0, 1000.0)
    # As a lost beam that was searched for: the pace of this step alone would make 50 000 s of the rest.
    clock.advance(500.0)
    left = progress.estimate(10.0, 1000.0)
    assert left.left_bench_s < 3000.0
    assert left.changed == "this part took 490 s more than expected"


def test_more_to_do_is_said() -> None:
    clock = ManualClock()
    progress = Progress(clock)
    progress.estimate(0.0, 1000.0)
    clock.advance(100.0)
    assert progress.estimate(100.0, 1500.0).changed == "500 s more to do than before"


async def test_a_hold_is_waiting_from_the_checkpoint_on() -> None:
    clock = ManualClock()
    control = running(clock)
    control.hold("Ada")
    clock.advance(5.0)
    held = asyncio.create_task(control.checkpoint())
    await until_idle()
    clock.advance(600.0)
    control.unhold("Ada")
    await held
    clock.advance(7.0)
    assert control.wait_time.idle_s == 600.0


async def test_a_suspension_is_waiting_and_a_hold_meanwhile_counts_once() -> None:
    clock = ManualClock()
    control = running(clock)
    closed = False

    async def look() -> bool:
        return closed

    suspended = asyncio.create_task(control.suspended("the door is open", look, 1.0))
    await until_idle()
    clock.advance(30.0)
    await until_idle()
    control.hold("Ada")
    clock.advance(1.0)
    await until_idle()
    clock.advance(100.0)
    closed = True
    control.unhold("Ada")
    for _ in range(10):
        await until_idle()
        clock.advance(1.0)
    await suspended
    # The second between the order and the next look it was on its way to the hold.
    assert control.wait_time.idle_s == 30.0 + 100.0


def test_a_wait_that_goes_on_counts_up_to_now() -> None:
    clock = ManualClock()
    control = running(clock)
    control.suspend("the door is open")
    clock.advance(300.0)
    # Whoever answers a question meanwhile takes these seconds out of the time that the question took.
    assert control.wait_time.idle_s == 300.0
    clock.advance(50.0)
    control.condition_back("it is closed")
    clock.advance(7.0)
    assert control.wait_time.idle_s == 350.0
