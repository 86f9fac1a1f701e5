"""What waits for a slow client, what is replaced, what is dropped, and what never is."""

import pytest

from catseye.app.protocol.engine_events import Client, ClientsChanged, Dropped
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.requests import Plain
from catseye.app.protocol.run_events import (
    ErrorReported,
    LiveData,
    LiveShown,
    PointMeasured,
    Progressed,
    WarningIssued,
)
from catseye.app.protocol.state import ControlState
from catseye.app.service.mailbox import Mailbox, MailboxFullError
from tests.unit.app.service.benches import ServiceBench, close, settled


def point(number: int) -> PointMeasured:
    return PointMeasured(step=str(number), point={})


def live(name: str, value: float) -> LiveShown:
    data = LiveData(name=name, value=value, unit="mm", low=None, high=None, accepted=True, text="")
    return LiveShown(state=ControlState.EXECUTE, data=data)


def progress(done: float) -> Progressed:
    return Progressed(
        done=done, total=1000.0, text="", elapsed_bench_s=0.0, left_bench_s=0.0, elapsed_s=0.0, left_s=0.0
    )


def clients(*names: str) -> ClientsChanged:
    return ClientsChanged(clients=tuple(Client(client=f"{name}-1", who=name) for name in names))


WARNING = WarningIssued(text="weak")
ERROR = ErrorReported(text="lost", exit_code=4)


async def taken(mailbox: Mailbox) -> list[AnyEvent | bytes]:
    mailbox.close()
    found = []
    while True:
        try:
            found.append(await mailbox.take())
        except EOFError:
            return found


async def test_only_the_newest_live_values_and_progress_are_queued() -> None:
    mailbox = Mailbox()
    for value in range(1000):
        mailbox.put(live("offset", value))
        mailbox.put(live("signal", -value))
        mailbox.put(progress(value))
    assert await taken(mailbox) == [live("offset", 999), live("signal", -999), progress(999)]


async def test_points_beyond_the_capacity_are_dropped_and_counted() -> None:
    mailbox = Mailbox(capacity=3)
    for number in range(10):
        mailbox.put(point(number))
    assert await taken(mailbox) == [Dropped(count=7), point(0), point(1), point(2)]


async def test_undroppable_events_displace_points() -> None:
    mailbox = Mailbox(capacity=2)
    mailbox.put(point(0))
    mailbox.put(WARNING)
    mailbox.put(ERROR)
    assert await taken(mailbox) == [Dropped(count=1), WARNING, ERROR]


async def test_the_newest_list_of_clients_is_never_dropped() -> None:
    mailbox = Mailbox(capacity=2)
    mailbox.put(point(0))
    mailbox.put(point(1))
    mailbox.put(clients("Ada"))
    mailbox.put(WARNING)
    mailbox.put(clients("Ada", "Ben"))
    assert await taken(mailbox) == [Dropped(count=2), clients("Ada", "Ben"), WARNING]


def test_a_mailbox_full_of_undroppable_events_raises() -> None:
    mailbox = Mailbox(capacity=2)
    mailbox.put(WARNING)
    mailbox.put(ERROR)
    with pytest.raises(MailboxFullError):
        mailbox.put(b'{"re": 1, "ok": true}')


async def test_a_late_reader_gets_every_point_or_the_dropped_count() -> None:
    async with ServiceBench().running() as bench:
        client = await bench.raw(buffer_bytes=4096)
        assert (await client.ask("hello", client="slow", who="Ada"))["ok"]
        for number in range(3000):
            bench.publish("point", step=str(number), point={"displacement_mm": 0.1})
            await settled(1)
        bench.publish("error", text="last", exit_code=1)
        received, dropped = 0, 0
        while True:
            message = await client.read()
            received += message["event"] == "point"
            dropped += message.get("count", 0)
            if message["event"] == "error":
                break
        assert dropped > 1000
        assert received + dropped == 3000
        close(client)


async def test_a_client_that_never_reads_is_lost() -> None:
    async with ServiceBench().running() as bench, bench.client("Ben") as watcher:
        client = await bench.raw(buffer_bytes=4096)
        assert (await client.ask("hello", client="stuck", who="Ada"))["ok"]
        assert (await client.ask("control"))["ok"]
        for _ in range(3000):
            bench.publish("warning", text="w" * 100, data={})
            # The watcher reads meanwhile.
            await settled(4)
            while len(watcher.inbox):
                await watcher.inbox.take()
        await settled()
        [lost] = bench.noted("client-lost")
        assert lost["who"] == "Ada"
        assert "does not read" in str(lost["reason"])
        assert bench.state() == "HOLDING"
        assert (await watcher.request(Plain(op="ping")))["ok"]
        close(client)


async def test_a_stop_from_a_client_not_reading_acts_immediately() -> None:
    async with ServiceBench().running() as bench:
        client = await bench.raw(buffer_bytes=4096)
        assert (await client.ask("hello", client="stuck", who="Ada"))["ok"]
        for number in range(2000):
            bench.publish("point", step=str(number), point={})
        client.send("stop")
        await settled()
        assert bench.state() in {"STOPPING", "STOPPED"}
        assert bench.robot.calls == ["stop"]
        close(client)
