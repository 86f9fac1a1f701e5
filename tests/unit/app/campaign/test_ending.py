"""A job ends when it has to, whatever becomes of the clock on the wall and of the stage under way."""

import asyncio
import signal
from datetime import UTC, datetime, timedelta

from catseye.app.campaign.deadline import Deadline
from catseye.app.campaign.ending import Ending
from tests.unit.app.engine.fakes import ManualClock

EVENING = datetime(2026, 1, 2, 20, 0, tzinfo=UTC)


class SetClock(ManualClock):
    """A clock on the wall that somebody sets while time goes on."""

    def __init__(self) -> None:
        super().__init__()
        self.set_by = timedelta()

    def now_utc(self) -> datetime:
        return EVENING + timedelta(seconds=self.time_s) + self.set_by

    async def sleep(self, duration_s: float) -> None:
        self.advance(duration_s)
        await asyncio.sleep(0)


async def ended_after_s(deadline: Deadline, set_by: timedelta) -> float:
    """Return how long a job goes on whose clock is set at its begin."""
    clock = SetClock()
    ending = Ending(clock)
    clock.set_by = set_by
    await ending.at(deadline)
    assert ending.cause is not None
    assert ending.cause.code == "deadline"
    return clock.time_s


async def test_a_time_goes_by_the_wall_clock() -> None:
    deadline = Deadline(EVENING + timedelta(hours=2))
    assert await ended_after_s(deadline, timedelta(hours=1)) == 3600.0
    assert await ended_after_s(deadline, timedelta(hours=-1)) == 3 * 3600.0


async def test_a_duration_goes_by_no_wall_clock() -> None:
    deadline = Deadline(EVENING + timedelta(hours=2), within_s=7200.0)
    assert await ended_after_s(deadline, timedelta(hours=1)) == 7200.0
    assert await ended_after_s(deadline, timedelta(hours=-1)) == 7200.0


async def test_a_stage_that_ignores_sigterm_is_killed() -> None:
    clock = ManualClock()
    sent: list[int] = []
    ending = Ending(clock)
    ending.started(sent.append)
    ending.deliver(signal.SIGTERM)
    ending.deliver(signal.SIGTERM)
    while signal.SIGKILL not in sent:
        await asyncio.sleep(0)
        clock.advance(30.0)
    assert sent == [signal.SIGTERM, signal.SIGKILL]
    assert clock.time_s >= 60.0


async def test_sigterm_before_a_stage_starts_ends_it_at_once() -> None:
    sent: list[int] = []
    ending = Ending(ManualClock())
    ending.deliver(signal.SIGTERM)
    await asyncio.sleep(0)
    ending.started(sent.append)
    await asyncio.sleep(0)
    assert sent == [signal.SIGTERM]
    ending.over()
