"""The time left is estimated from the pace of the run, whoever has kept it waiting."""

import asyncio

from catseye.app.engine.control import RunControl
from catseye.app.engine.timekeeping import Progress
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
    # Ten expected seconds took twenty; 190 are left.
    assert progress.estimate(110.0, 300.0, 3600.0) == (3620.0, 380.0)


def test_a_wait_before_the_first_estimate_counts_as_little() -> None:
    clock = ManualClock()
    progress = Progress(clock)
    clock.advance(1000.0)
    progress.estimate(100.0, 300.0, 1000.0)
    clock.advance(20.0)
    assert progress.estimate(110.0, 300.0, 1000.0) == (1020.0, 380.0)


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
