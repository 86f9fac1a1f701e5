"""A driver and its emulator, joined by a pipe; bench time passes as fast as the stream is taken."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any

from catseye.app.testing.memory import MemoryTransport
from catseye.drivers.roles.errors import LinkError
from catseye.simulators.config import EmulatedDevice, Option
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import sessions_of
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.ports.session import Pending, Session
from catseye.simulators.world.air_probe import AirSensors
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.journal import Journal
from catseye.simulators.world.scara.room import levelled_tracker
from catseye.simulators.world.timekeeper import TimeKeeper
from tests.unit.drivers.peers import FarEnd, StepClock
from tests.unit.simulators.benches import QUIET, aimed, go, quiet_bench


def quiet_world() -> EmulationContext:
    """Return a world whose beam returns from P2, without noise."""
    bench = quiet_bench()
    go(bench, aimed(20.0, 30.0))
    controller = Controller(bench, QUIET, lambda: None)
    journal = Journal(lambda: bench.time_s)
    keeper = TimeKeeper(bench, clock=lambda: 0.0)
    air, tracker = AirSensors(bench), levelled_tracker(bench, QUIET)
    return EmulationContext(QUIET, bench, {}, controller, keeper, journal, air, tracker)


def maker(
    world: EmulationContext, protocol: str, options: Mapping[str, Option] | None = None
) -> Callable[[], Session]:
    """Return what makes the sessions of one emulated instrument."""
    device = EmulatedDevice("interferometer", protocol, options=options or {})
    return sessions_of(world, device, lambda _text: None)


def new_session(
    world: EmulationContext, protocol: str, options: Mapping[str, Option] | None = None
) -> Session:
    """Return a session of a protocol as a client of the emulation meets it."""
    return maker(world, protocol, options)()


class BenchClock(StepClock):
    """A clock whose sleeps let the bench's time pass, too."""

    def __init__(self, bench: Bench) -> None:
        super().__init__()
        self._bench = bench

    async def sleep(self, duration_s: float) -> None:
        self._bench.advance(duration_s)
        await super().sleep(duration_s)


class Far(FarEnd):
    """Plays the emulator at the far end of a pipe.

    Args:
        world: the emulated bench.
        session: makes the session of a new client.

    Attributes:
        passed: from what the instrument says to what arrives of it.
    """

    def __init__(self, world: EmulationContext, session: Callable[[], Session]) -> None:
        super().__init__("memory://instrument")
        self.world = world
        self.muted = False
        self.new_session = session
        self.passed: Callable[[bytes], bytes] = lambda data: data

    async def _serve(self) -> None:
        while True:
            session = self.new_session()
            with contextlib.suppress(LinkError):
                await self._converse(session)
            session.close()

    async def _converse(self, session: Session) -> None:
        while True:
            due_s = session.next_output_s()
            if due_s is None:
                session.feed(await self.far.read())
            else:
                with contextlib.suppress(TimeoutError):
                    async with asyncio.timeout(0):
                        session.feed(await self.far.read())
            await self._answer(session)
            if (due_s := session.next_output_s()) is not None:
                self.world.beam_bench.advance_to(due_s)
                await self._say(session.output())
            await asyncio.sleep(0)

    async def _answer(self, session: Session) -> None:
        while (answer := session.answer()) is not None:
            if isinstance(answer, Pending):
                while (due_s := answer.due()) is not None:
                    self.world.beam_bench.advance_to(due_s)
                answer = answer.reply()
            await self._say(answer)

    async def _say(self, data: bytes) -> None:
        if data and not self.muted and self.near.is_open and (arriving := self.passed(data)):
            await self.far.write(arriving)


@dataclass(frozen=True)
class Pair:
    """A driver and the world that it looks at."""

    driver: Any
    world: EmulationContext
    far: Far
    clock: StepClock

    @property
    def bench(self) -> Bench:
        return self.world.beam_bench


Make = Callable[[MemoryTransport, StepClock], Any]


@asynccontextmanager
async def paired(
    protocol: str, make: Make, options: Mapping[str, Option] | None = None, *, connect: bool = True
) -> AsyncIterator[Pair]:
    """Join a driver to the emulator of its protocol."""
    world = quiet_world()
    clock = BenchClock(world.beam_bench)
    async with Far(world, maker(world, protocol, options)) as far:
        driver = make(far.near, clock)
        if connect:
            await driver.connect()
        try:
            yield Pair(driver, world, far, clock)
        finally:
            await driver.close()
