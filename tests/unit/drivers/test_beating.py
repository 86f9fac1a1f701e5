"""Signs of life come at their time, however long one of them takes."""

import asyncio

from catseye.drivers.links.beating import beating


async def test_a_slow_answer_does_not_put_the_next_beat_off() -> None:
    begun: list[float] = []
    loop = asyncio.get_running_loop()

    async def slow() -> None:
        begun.append(loop.time())
        # An answer takes most of the period.
        async with asyncio.timeout(1.0):
            await passed(0.08)

    async def passed(duration_s: float) -> None:
        done = asyncio.Event()
        loop.call_later(duration_s, done.set)
        await done.wait()

    async with beating(slow, 0.1):
        await passed(0.55)
    # A period behind each answer would leave room for four.
    assert len(begun) >= 5
