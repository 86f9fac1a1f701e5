"""A client that reads slowly gets the newest bench, and columns and lines that are not too old; others count."""

import asyncio
from typing import TypeVar

from hypothesis import given
from hypothesis import strategies as st

from catseye.app.protocol.bench import WireLine
from catseye.app.protocol.engine_events import BenchSeen, SamplesTaken, WirePassed
from catseye.app.protocol.events import AnyEvent
from catseye.app.service.mailbox import Mailbox
from catseye.app.service.watching.columns import MOST_COLUMNS
from catseye.app.service.watching.traffic import MOST_LINES
from tests.unit.app.service.manual.benches import bench_seen

BENCH = bench_seen()

T = TypeVar("T", BenchSeen, SamplesTaken, WirePassed)


async def read(mailbox: Mailbox, kind: type[T]) -> T:
    found = await mailbox.take()
    assert isinstance(found, kind)
    return found


def delivered(events: list[T], reads: list[bool]) -> list[T]:
    """Put events, read the mailbox empty after some of them, and return what was read."""

    async def play() -> list[T]:
        mailbox, taken = Mailbox(), list[T]()
        for event, now in zip(events, reads, strict=True):
            mailbox.put(event)
            while now and len(mailbox):
                taken.append(await read(mailbox, type(event)))
        while len(mailbox):
            taken.append(await read(mailbox, type(events[-1])))
        return taken

    return asyncio.run(play())


def columns(first: int, count: int, missed: int = 0) -> SamplesTaken:
    numbers = range(first, first + count)
    return SamplesTaken(
        quantity="displacement_mm",
        period_s=0.02,
        low=tuple(float(number) for number in numbers),
        high=tuple(number + 0.5 if number % 2 else None for number in numbers),
        count=tuple(numbers),
        missed=missed,
    )


@given(st.lists(st.booleans(), min_size=1, max_size=30))
def test_the_newest_bench_comes_and_says_how_many_it_replaced(reads: list[bool]) -> None:
    events = [BENCH.model_copy(update={"disk_free_bytes": number}) for number in range(len(reads))]
    found = delivered(events, reads)
    assert found[-1].disk_free_bytes == len(reads) - 1
    assert sum(bench.missed + 1 for bench in found) == len(reads)


@given(st.lists(st.tuples(st.integers(0, 300), st.integers(0, 3), st.booleans()), min_size=1, max_size=12))
def test_columns_come_once_in_their_order_or_are_counted(events: list[tuple[int, int, bool]]) -> None:
    samples, first = list[SamplesTaken](), 0
    for count, missed, _ in events:
        samples.append(columns(first, count, missed))
        first += count
    found = delivered(samples, [now for _, _, now in events])
    numbers = [number for event in found for number in event.count]
    assert numbers == sorted(set(numbers))
    assert all(len(event.count) <= MOST_COLUMNS for event in found)
    for event in found:
        assert event.low == tuple(float(number) for number in event.count)
        assert event.high == tuple(number + 0.5 if number % 2 else None for number in event.count)
    assert len(numbers) + sum(event.missed for event in found) == first + sum(m for _, m, _ in events)


def test_lines_are_joined_up_to_the_most_of_a_message() -> None:
    def wire(first: int, count: int) -> WirePassed:
        lines = [
            WireLine(t="now", device="umd", dir="rx", hex=f"{n:04x}") for n in range(first, first + count)
        ]
        return WirePassed(lines=tuple(lines), missed=0)

    [found] = delivered([wire(0, 150), wire(150, 100), wire(250, 20)], [False, False, False])
    assert [int(line.hex, 16) for line in found.lines] == [*range(270 - MOST_LINES, 270)]
    assert found.missed == 270 - MOST_LINES


def test_merging_in_one_mailbox_leaves_other_clients_events_unchanged() -> None:
    """The same event lies in the mailboxes of all clients."""

    async def play() -> None:
        slow, quick, shared = Mailbox(), Mailbox(), [columns(0, 2), columns(2, 2)]
        for event in shared:
            for mailbox in (slow, quick):
                mailbox.put(event)
            await quick.take()
        assert (await read(slow, SamplesTaken)).count == (0, 1, 2, 3)
        assert [event.count for event in shared] == [(0, 1), (2, 3)]

    asyncio.run(play())


def test_events_of_different_kinds_are_not_merged() -> None:
    async def play() -> list[AnyEvent | bytes]:
        mailbox = Mailbox()
        mailbox.put(columns(0, 1))
        mailbox.put(BENCH)
        return [await mailbox.take(), await mailbox.take()]

    assert [type(event) for event in asyncio.run(play())] == [SamplesTaken, BenchSeen]
