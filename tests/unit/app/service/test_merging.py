"""A client that reads slowly gets the newest bench, and columns and lines that are not too old; others count."""

import asyncio
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from catseye.app.service.mailbox import Mailbox
from catseye.app.service.messages import Message
from catseye.app.service.watching.columns import MOST_COLUMNS
from catseye.app.service.watching.traffic import MOST_LINES


def delivered(messages: list[Message], reads: list[bool]) -> list[dict[str, Any]]:
    """Put messages, read the mailbox empty after some of them, and return what was read."""

    async def play() -> list[Message]:
        mailbox, taken = Mailbox(), list[Message]()
        for message, read in zip(messages, reads, strict=True):
            mailbox.put(message)
            while read and len(mailbox):
                taken.append(await mailbox.take())
        while len(mailbox):
            taken.append(await mailbox.take())
        return taken

    return asyncio.run(play())


def bench(number: int) -> Message:
    return {"event": "bench", "number": number, "missed": 0}


def columns(first: int, count: int, missed: int = 0) -> Message:
    numbers = range(first, first + count)
    return {
        "event": "samples",
        "period_s": 0.02,
        "low": [float(number) for number in numbers],
        "high": [number + 0.5 if number % 2 else None for number in numbers],
        "count": [*numbers],
        "missed": missed,
    }


@given(st.lists(st.booleans(), min_size=1, max_size=30))
def test_the_newest_bench_comes_and_says_how_many_it_replaced(reads: list[bool]) -> None:
    read = delivered([bench(number) for number in range(len(reads))], reads)
    assert read[-1]["number"] == len(reads) - 1
    assert sum(message["missed"] + 1 for message in read) == len(reads)


@given(st.lists(st.tuples(st.integers(0, 300), st.integers(0, 3), st.booleans()), min_size=1, max_size=12))
def test_columns_come_once_in_their_order_or_are_counted(events: list[tuple[int, int, bool]]) -> None:
    messages, first = list[Message](), 0
    for count, missed, _ in events:
        messages.append(columns(first, count, missed))
        first += count
    read = delivered(messages, [now for _, _, now in events])
    numbers = [number for message in read for number in message["count"]]
    assert numbers == sorted(set(numbers))
    assert all(len(message["count"]) <= MOST_COLUMNS for message in read)
    for message in read:
        assert message["low"] == [float(number) for number in message["count"]]
        assert message["high"] == [number + 0.5 if number % 2 else None for number in message["count"]]
    assert len(numbers) + sum(message["missed"] for message in read) == first + sum(m for _, m, _ in events)


def test_lines_are_joined_up_to_the_most_of_a_message() -> None:
    def wire(first: int, count: int) -> Message:
        return {
            "event": "wire",
            "lines": [{"hex": f"{n:04x}"} for n in range(first, first + count)],
            "missed": 0,
        }

    [read] = delivered([wire(0, 150), wire(150, 100), wire(250, 20)], [False, False, False])
    assert [int(line["hex"], 16) for line in read["lines"]] == [*range(270 - MOST_LINES, 270)]
    assert read["missed"] == 270 - MOST_LINES


def test_what_one_client_has_not_read_is_not_mixed_up_with_what_another_reads() -> None:
    """The same message lies in the mailboxes of all clients."""

    async def play() -> None:
        slow, quick, shared = Mailbox(), Mailbox(), [columns(0, 2), columns(2, 2)]
        for message in shared:
            for mailbox in (slow, quick):
                mailbox.put(message)
            await quick.take()
        assert (await slow.take())["count"] == [0, 1, 2, 3]
        assert [message["count"] for message in shared] == [[0, 1], [2, 3]]

    asyncio.run(play())
