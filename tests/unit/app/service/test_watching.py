"""Clients that ask for the bench or the traffic receive it; the others, and those that left, do not."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Literal

import pytest

from catseye.app.engine.waiting import cancel
from catseye.app.protocol.answers import Answer, Watching
from catseye.app.protocol.engine_events import BenchSeen
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.requests import Watch
from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.errors import RefusedError
from catseye.app.service.mailbox import Mailbox
from catseye.app.service.member import Member
from catseye.app.service.request_handler import RequestHandler
from catseye.app.service.watching.bench_facts import facts_of
from catseye.app.service.watching.telemetry import Telemetry
from tests.unit.app.service.manual.benches import bench_from_template, cell_from_template
from tests.unit.app.service.watching.pulled_devices import disk
from tests.unit.drivers.virtual_time import VirtualClock, run


class Served:
    """A registry with its handler and two clients."""

    def __init__(self, folder: Path) -> None:
        clock = VirtualClock()
        self.registry = ClientRegistry(clock)
        self.telemetry = Telemetry(self.registry, clock, folder, disk)
        self.handler = RequestHandler(self.registry, telemetry=self.telemetry)
        self.ada, self.ben = (
            self.registry.join("test", who, Mailbox(), lambda _reason: None) for who in ("Ada", "Ben")
        )

    def ask(self, member: Member, op: Literal["watch", "traffic"], *, on: bool = True) -> Answer:
        answer = self.handler.take(member, Watch(op=op, on=on))
        assert not isinstance(answer, asyncio.Future)
        return answer


def played(folder: Path, play: Callable[[Served], Awaitable[None]]) -> None:
    async def whole() -> None:
        served = Served(folder)
        try:
            await play(served)
        finally:
            await served.telemetry.end()

    run(whole())


async def taken(member: Member) -> AnyEvent:
    event = await member.mailbox.take()
    assert not isinstance(event, bytes)
    return event


async def events(member: Member) -> list[str]:
    """Return the names of the events that wait for a client."""
    return [(await taken(member)).event for _ in range(len(member.mailbox))]


def test_subscribers_get_events_until_they_unsubscribe(tmp_path: Path) -> None:
    async def play(served: Served) -> None:
        served.telemetry.describe(facts_of(cell_from_template(), bench_from_template()))
        watching = served.ask(served.ada, "watch")
        assert isinstance(watching, Watching)
        assert watching.bench is not None
        assert watching.bench.cell == cell_from_template().name
        # That Ben came after her.
        assert await events(served.ada) == ["clients"]
        await asyncio.sleep(1.0)
        # Nothing was read meanwhile: one of each waits, and the replaced ones are counted.
        assert len(served.ada.mailbox) == 2
        bench = await taken(served.ada)
        assert isinstance(bench, BenchSeen)
        assert (bench.run, bench.missed) == (None, 4)
        assert await events(served.ada) == ["samples"]
        assert await events(served.ben) == []
        assert served.ask(served.ben, "traffic") == Answer()
        served.ask(served.ada, "watch", on=False)
        served.telemetry.traffic.record("robot", "tx", b"1")
        await asyncio.sleep(1.0)
        assert (await events(served.ada), await events(served.ben)) == ([], ["wire"])

    played(tmp_path, play)


def test_a_client_that_left_keeps_nothing_awake(tmp_path: Path) -> None:
    async def play(served: Served) -> None:
        watched: list[bool] = []
        served.telemetry.on_watched = watched.append
        served.ask(served.ada, "watch")
        served.ask(served.ben, "watch")
        await asyncio.sleep(1.0)
        served.registry.leave(served.ada, "it closed the connection")
        await asyncio.sleep(1.0)
        assert watched == [True]
        served.registry.leave(served.ben, "it closed the connection")
        await asyncio.sleep(1.0)
        assert watched == [True, False]

    played(tmp_path, play)


def test_a_bench_that_cannot_be_known_is_refused(tmp_path: Path) -> None:
    async def play(served: Served) -> None:
        def unknown() -> None:
            raise RefusedError("line 3: no such key")

        served.telemetry.prepare = unknown
        with pytest.raises(RefusedError, match="line 3"):
            served.ask(served.ada, "watch")
        assert not served.registry.listens("watch")
        request = Watch(op="watch")
        with pytest.raises(RefusedError, match="does not do 'watch'"):
            RequestHandler(served.registry).take(served.ada, request)
        with pytest.raises(RefusedError, match="says hello first"):
            served.handler.take(None, request)

    played(tmp_path, play)


def test_the_end_of_the_engine_ends_the_telling(tmp_path: Path) -> None:
    async def play(served: Served) -> None:
        served.ask(served.ada, "watch")
        publishing = asyncio.create_task(served.telemetry.end())
        await asyncio.sleep(0.1)
        await cancel(publishing)
        await events(served.ada)
        await asyncio.sleep(1.0)
        assert await events(served.ada) == []

    played(tmp_path, play)
