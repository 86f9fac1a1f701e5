"""Waiting leaves nothing behind, whatever happens meanwhile."""

import asyncio

import pytest

from catseye.app.engine.waiting import cancel, together, uncancelled, within
from tests.unit.app.engine.fakes import ManualClock


class Work:
    """Something that takes as long as a test asks, and remembers how it ended."""

    def __init__(self, error: Exception | None = None) -> None:
        self.begun = asyncio.Event()
        self.may_end = asyncio.Event()
        self.ended = ""
        self._error = error

    async def do(self) -> str:
        self.begun.set()
        try:
            await self.may_end.wait()
        except asyncio.CancelledError:
            self.ended = "cancelled"
            raise
        if self._error is not None:
            raise self._error
        self.ended = "done"
        return "result"


async def test_together_returns_results_in_order() -> None:
    async def value(number: int) -> int:
        return number

    assert await together(value(1), value(2)) == [1, 2]


async def test_together_raises_the_first_failure_plainly_and_ends_the_others() -> None:
    slow, broken = Work(), Work(ValueError("broken"))
    broken.may_end.set()
    with pytest.raises(ValueError, match="broken"):
        await together(slow.do(), broken.do())
    assert slow.ended == "cancelled"


async def test_within_returns_what_is_over_in_time() -> None:
    work = Work()
    work.may_end.set()
    assert await within(ManualClock(), 5.0, work.do()) == "result"


async def test_within_cancels_what_takes_too_long() -> None:
    clock, work = ManualClock(), Work()
    waiting = asyncio.create_task(within(clock, 5.0, work.do()))
    await work.begun.wait()
    await asyncio.sleep(0)
    clock.advance(5.0)
    with pytest.raises(TimeoutError, match="5 s"):
        await waiting
    assert work.ended == "cancelled"


@pytest.mark.parametrize("error", [None, ValueError("broken")])
async def test_uncancelled_goes_on_through_two_cancellations(error: Exception | None) -> None:
    work = Work(error)
    waiting = asyncio.create_task(uncancelled(work.do()))
    await work.begun.wait()
    for _ in range(2):
        waiting.cancel()
        await asyncio.sleep(0)
    work.may_end.set()
    with pytest.raises(asyncio.CancelledError):
        await waiting
    assert work.ended == ("" if error else "done")


async def test_cancel_waits_for_the_end() -> None:
    work = Work()
    task = asyncio.create_task(work.do())
    await work.begun.wait()
    await cancel(task)
    assert work.ended == "cancelled"
