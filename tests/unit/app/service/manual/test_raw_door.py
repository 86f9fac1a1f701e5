"""Bytes to a robot by hand pass a closed door only; one that opens is a STOP on that very link."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack

import pytest

from catseye.app.engine.door_watch import TICK_S
from catseye.app.errors import SafetyError
from catseye.app.service.manual.raw_door import RawDoor, raw_door
from catseye.app.testing.memory import MemoryTransport, pipe
from tests.unit.app.engine.test_door_watch import Watched

STOP = b"\r2;3;STOP\r"


class Link:
    """A robot's link with the door of its cell."""

    def __init__(self) -> None:
        self.near, self.far = pipe()
        self.watched = Watched()
        self.reported: list[str] = []
        self.stack = AsyncExitStack()

    async def begin(self, *, watched: bool = True, stop: bytes | None = STOP) -> RawDoor:
        """Open both ends and watch the door."""
        await self.near.open()
        await self.far.open()
        io = self.watched.door if watched else None
        return await self.stack.enter_async_context(
            raw_door(io, self.near, stop, self.watched.clock, self.reported.append)
        )


@pytest.fixture
async def link() -> AsyncIterator[Link]:
    made = Link()
    async with made.stack:
        yield made
    for end in (made.near, made.far):
        await end.close()


def sent(far: MemoryTransport) -> bytes:
    """Return what the robot was sent."""
    return far.waiting()


async def test_a_door_that_opens_is_a_stop_on_the_link(link: Link) -> None:
    door = await link.begin()
    door.require_closed()
    link.watched.door.closed = False
    await link.watched.pass_s(4 * TICK_S)
    assert sent(link.far) == STOP
    assert link.reported == ["the door is open: no motion; close it when nobody is inside; STOP was sent"]
    with pytest.raises(SafetyError, match="door is open"):
        door.require_closed()


async def test_each_opening_is_a_stop_of_its_own(link: Link) -> None:
    door = await link.begin()
    for _ in range(2):
        link.watched.door.closed = False
        await link.watched.pass_s(3 * TICK_S)
        link.watched.door.closed = True
        await link.watched.pass_s(3 * TICK_S)
        door.require_closed()
    stops = [await link.far.read() for _ in range(2)]
    assert stops == [STOP] * 2


async def test_a_link_not_taking_stop_calls_for_the_emergency_stop(link: Link) -> None:
    await link.begin()
    await link.near.close()
    link.watched.door.closed = False
    await link.watched.pass_s(2 * TICK_S)
    assert "PRESS THE EMERGENCY STOP" in link.reported[-1]


async def test_a_driver_without_stop_calls_for_the_emergency_stop(link: Link) -> None:
    await link.begin(stop=None)
    link.watched.door.closed = False
    await link.watched.pass_s(2 * TICK_S)
    assert "PRESS THE EMERGENCY STOP" in link.reported[-1]
    assert sent(link.far) == b""


async def test_without_a_watched_door_bytes_pass(link: Link) -> None:
    door = await link.begin(watched=False)
    door.require_closed()
    assert sent(link.far) == b""


@pytest.mark.parametrize(
    ("fault", "why"),
    [
        (RuntimeError("a fault of the program"), "a fault of the program"),
        (asyncio.CancelledError(), "the watch was cancelled"),
    ],
)
async def test_a_watch_that_ends_counts_as_an_open_door(link: Link, fault: BaseException, why: str) -> None:
    door = await link.begin()

    async def fail() -> bool:
        raise fault

    link.watched.door.door_closed = fail  # type: ignore[method-assign]  # a driver with a fault
    await link.watched.pass_s(4 * TICK_S)
    assert sent(link.far) == STOP
    with pytest.raises(SafetyError, match=f"watched no more: {why}"):
        door.require_closed()
