"""Clients that ask for the bench or the traffic are told; the others, and those that left, are not."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from catseye.app.engine.waiting import cancel
from catseye.app.service.errors import RefusedError
from catseye.app.service.hub import Hub, Member
from catseye.app.service.mailbox import Mailbox
from catseye.app.service.messages import Message, Watch, decode_request, encode
from catseye.app.service.orders import Orders
from catseye.app.service.watching.bench_facts import facts_of
from catseye.app.service.watching.telemetry import Telemetry
from tests.unit.app.service.manual.benches import bench_from_template, cell_from_template
from tests.unit.app.service.watching.pulled_devices import disk
from tests.unit.drivers.virtual_time import VirtualClock, run


class Served:
    """A hub with its orders and two clients."""

    def __init__(self, folder: Path) -> None:
        clock = VirtualClock()
        self.hub = Hub(clock)
        self.telemetry = Telemetry(self.hub, clock, folder, disk)
        self.orders = Orders(self.hub, telemetry=self.telemetry)
        self.ada, self.ben = (
            self.hub.join("test", who, Mailbox(), lambda _reason: None) for who in ("Ada", "Ben")
        )

    def ask(self, member: Member, op: str, *, on: bool = True) -> Message:
        request = decode_request(encode({"v": 1, "id": 1, "op": op, "on": on}))
        answer = self.orders.take(member, request)
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


async def events(member: Member) -> list[str]:
    """Return the events that wait for a client."""
    return [str((await member.mailbox.take())["event"]) for _ in range(len(member.mailbox))]


def test_whoever_asks_is_answered_and_told_until_he_asks_no_more(tmp_path: Path) -> None:
    async def play(served: Served) -> None:
        served.telemetry.describe(facts_of(cell_from_template(), bench_from_template()))
        bench = served.ask(served.ada, "watch")["bench"]
        assert isinstance(bench, dict)
        assert bench["cell"] == cell_from_template().name
        # That Ben came after her.
        assert await events(served.ada) == ["clients"]
        await asyncio.sleep(1.0)
        # Nothing was read meanwhile: one of each waits, and the replaced ones are counted.
        assert len(served.ada.mailbox) == 2
        told = await served.ada.mailbox.take()
        assert (told["event"], told["run"], told["missed"]) == ("bench", None, 4)
        assert await events(served.ada) == ["samples"]
        assert await events(served.ben) == []
        assert served.ask(served.ben, "traffic") == {}
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
        served.hub.leave(served.ada, "it closed the connection")
        await asyncio.sleep(1.0)
        assert watched == [True]
        served.hub.leave(served.ben, "it closed the connection")
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
        assert not served.hub.listens("watch")
        request = Watch(v=1, id=1, op="watch")
        with pytest.raises(RefusedError, match="does not do 'watch'"):
            Orders(served.hub).take(served.ada, request)
        with pytest.raises(RefusedError, match="says hello first"):
            served.orders.take(None, request)

    played(tmp_path, play)


def test_the_end_of_the_engine_ends_the_telling(tmp_path: Path) -> None:
    async def play(served: Served) -> None:
        served.ask(served.ada, "watch")
        telling = asyncio.create_task(served.telemetry.end())
        await asyncio.sleep(0.1)
        await cancel(telling)
        await events(served.ada)
        await asyncio.sleep(1.0)
        assert await events(served.ada) == []

    played(tmp_path, play)
