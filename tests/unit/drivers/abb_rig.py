"""A driver in front of the emulated controller, over real loopback sockets: what the tests of both share."""

import asyncio
from collections.abc import AsyncIterator, Awaitable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any

from catseye.drivers.abb.robot import AbbRws
from catseye.drivers.roles.clock import SystemClock
from catseye.simulators.config import Option
from catseye.simulators.emulated_bench import EmulatedAbbBench
from catseye.simulators.ports.lossy import Lossy
from tests.unit.simulators.abb.benches import BENT, abb_bench

AWAY = (60.0, *BENT[1:])
STRICT: dict[str, Option] = {"strict_counts": True, "explicit_mastership": True}
"""A controller that refuses whatever it may refuse."""

STOP = "POST /rw/rapid/execution?action=stop"
ORDER = "POST /rw/rapid/symbol/data/RAPID/T_ROB1/CATSABB/cats_seq"


class Searches(Lossy):
    """Loses what searches find."""

    def __init__(self) -> None:
        super().__init__(0.0, 1)

    def passed(self, answer: bytes) -> bytes:
        return b"" if b"symburl" in answer else answer


@dataclass
class Rig:
    """A driver and the bench behind it."""

    bench: EmulatedAbbBench
    robot: AbbRws
    wire: list[bytes] = field(default_factory=list)

    @property
    def j1_deg(self) -> float:
        return self.bench.bench.joints[0]

    def asked(self, beginning: str) -> list[str]:
        """Return the requests that begin so."""
        entries = self.bench.journal.entries("robot")
        return [e.text for e in entries if e.kind == "request" and e.text.startswith(beginning)]

    async def moves(self) -> None:
        """Wait until the arm moves."""
        while not self.bench.bench.moving:
            await asyncio.sleep(0)
            self.bench.keeper.sync()

    async def away(self) -> "asyncio.Task[None]":
        """Begin a motion that takes seconds."""
        await self.robot.set_override(5)
        motion = asyncio.create_task(self.robot.move_joints(AWAY))
        await self.moves()
        return motion


@asynccontextmanager
async def rig(options: dict[str, Option] | None = None, **settings: Any) -> AsyncIterator[Rig]:
    wire: list[bytes] = []
    async with abb_bench(options=options) as bench:
        endpoint = bench.endpoints[0].endpoint
        robot = AbbRws.at(endpoint, SystemClock(), lambda _way, data: wire.append(data), **settings)
        try:
            await robot.connect()
            yield Rig(bench, robot, wire)
        finally:
            await robot.close()


async def failed(motion: Awaitable[None]) -> BaseException:
    """Return why a motion failed."""
    (error,) = await asyncio.gather(motion, return_exceptions=True)
    assert isinstance(error, BaseException)
    return error
