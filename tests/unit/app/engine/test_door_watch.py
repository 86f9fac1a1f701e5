"""The door: asked all the time, believed when it answers, open when it does not."""

import asyncio
from collections.abc import AsyncIterator

import pytest

from catseye.app.engine.door_watch import TICK_S, DoorWatch
from catseye.app.engine.gate import MotionGate
from catseye.app.engine.waiting import cancel
from catseye.app.errors import InterruptionError
from catseye.drivers.roles.errors import LinkError
from tests.unit.app.engine.fakes import ARM, HOME, FakeRobot, ManualClock, free_way
from tests.unit.app.engine.test_interlock import Block


class Counted(Block):
    """Counts questions; some of the next ones get no answer, all hang when it is deaf."""

    def __init__(self) -> None:
        super().__init__()
        self.asked = 0
        self.lost = 0
        self.deaf = False

    async def door_closed(self) -> bool:
        self.asked += 1
        if self.deaf:
            await asyncio.Event().wait()
        if self.lost:
            self.lost -= 1
            self.silent = True
        try:
            return await super().door_closed()
        finally:
            self.silent = False


class SteppedClock(ManualClock):
    """Sleeps until the test advances the time."""

    async def sleep(self, duration_s: float) -> None:
        event = asyncio.Event()
        self._sleepers.append((self.time_s + duration_s, event))
        await event.wait()


class Watched:
    """A door and its watch, on a clock that the test moves."""

    def __init__(self, speed: float = 1.0) -> None:
        self.clock, self.door, self.reported = SteppedClock(), Counted(), list[str]()
        self.speed = speed
        self.watch = DoorWatch(self.door, self.clock, self.reported.append, speed)

    async def pass_s(self, real_s: float) -> None:
        """Let real time pass, tick by tick."""
        for _ in range(round(real_s / TICK_S)):
            self.clock.advance(TICK_S * self.speed)
            for _ in range(10):
                await asyncio.sleep(0)


@pytest.fixture(params=[1.0, 50.0])
async def watched(request: pytest.FixtureRequest) -> AsyncIterator[Watched]:
    made = Watched(request.param)
    await made.watch.look()
    task = asyncio.create_task(made.watch.watch())
    await asyncio.sleep(0)
    yield made
    await cancel(task)


async def test_the_door_is_asked_ten_times_a_real_second(watched: Watched) -> None:
    before = watched.door.asked
    await watched.pass_s(3.0)
    assert watched.door.asked - before >= 30
    assert watched.watch.trouble is None


async def test_an_open_door_is_reported_at_the_next_look(watched: Watched) -> None:
    await watched.pass_s(0.6)
    watched.door.closed = False
    await watched.pass_s(TICK_S)
    assert watched.reported == ["the door is open: no motion; close it when nobody is inside"]
    watched.door.closed = True
    await watched.pass_s(TICK_S)
    assert watched.watch.trouble is None


async def test_one_lost_answer_is_asked_again_and_stops_nothing(watched: Watched) -> None:
    for _ in range(20):
        watched.door.lost = 1
        await watched.pass_s(0.6)
    assert watched.reported == []


async def test_a_silent_door_counts_as_open_within_its_limit(watched: Watched) -> None:
    watched.door.lost = 1000
    asked = watched.door.asked
    await watched.pass_s(0.24)
    assert watched.reported == []
    await watched.pass_s(0.12)
    assert "does not answer, which counts as open" in watched.reported[0]
    assert watched.door.asked - asked >= 2


async def test_a_question_that_hangs_counts_as_silence(watched: Watched) -> None:
    await watched.pass_s(0.6)
    watched.door.deaf = True
    await watched.pass_s(0.42)
    assert "counts as open" in str(watched.watch.trouble)


async def test_the_gate_refuses_an_open_or_unseen_door() -> None:
    watched, robot = Watched(), FakeRobot(ManualClock())
    await robot.servo(on=True)
    await robot.set_override(20.0)
    gate = MotionGate(robot, ARM.axes, free_way, 20.0, door=watched.watch)
    with pytest.raises(InterruptionError, match="has not been looked at"):
        await gate.require(HOME)
    await watched.watch.look()
    await gate.require(HOME)
    watched.door.closed = False
    await watched.watch.look()
    with pytest.raises(InterruptionError, match="door is open: no motion; close it"):
        await gate.require(HOME)


async def test_each_failure_of_a_silent_door_is_the_same_trouble() -> None:
    watched = Watched()
    failures = iter(range(1000))

    async def noise() -> bool:
        raise LinkError(f"garbage {next(failures)}")

    watched.door.door_closed = noise  # type: ignore[method-assign]  # a link that is disturbed
    watch = asyncio.create_task(watched.watch.watch())
    await watched.pass_s(20 * TICK_S)
    assert len(watched.reported) > 1
    assert len(set(watched.reported)) == 1
    assert "garbage" in str(watched.watch.trouble)
    await cancel(watch)
