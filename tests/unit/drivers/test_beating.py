"""Signs of life come at their time, however long one of them takes."""

import asyncio

import pytest

from catseye.drivers.links.beating import Beat, beating
from catseye.drivers.roles.errors import LinkError
from tests.unit.drivers.virtual_time import run

PERIOD_S = 0.1


class Signs:
    """What was said, and when.

    Attributes:
        said: times and connections.
    """

    def __init__(self) -> None:
        self.said: list[tuple[float, str]] = []

    def on(self, name: str, answer_s: float, error: Exception | None = None) -> Beat:
        """Return what says something on a connection whose answers take their time."""

        async def beat() -> None:
            self.said.append((asyncio.get_running_loop().time(), name))
            await asyncio.sleep(answer_s)
            if error is not None:
                raise error

        return beat


def said_within(
    duration_s: float, signs: Signs, *beats: Beat, at_once: bool = True
) -> list[tuple[float, str]]:
    """Return what is said in a time, to hundredths of a second."""

    async def work() -> None:
        async with beating(beats, PERIOD_S, at_once=at_once):
            await asyncio.sleep(duration_s)

    run(work())
    return [(round(time_s, 2), name) for time_s, name in signs.said]


def test_a_slow_answer_does_not_put_the_next_beat_off() -> None:
    signs = Signs()
    said = said_within(0.45, signs, signs.on("a", 0.08))
    assert [time_s for time_s, _ in said] == [0.0, 0.1, 0.2, 0.3, 0.4]


def test_another_connection_speaks_while_one_waits() -> None:
    signs = Signs()
    said = said_within(0.55, signs, signs.on("a", 0.4), signs.on("b", 0.4))
    assert said == [(0.0, "a"), (0.1, "b"), (0.4, "a"), (0.5, "b")]


def test_a_connection_without_answers_costs_no_beat() -> None:
    signs = Signs()
    said = said_within(0.95, signs, signs.on("a", 5.0), signs.on("b", 0.01))
    assert [time_s for time_s, _ in said] == pytest.approx([0.1 * count for count in range(10)])
    assert [name for _, name in said] == ["a", *"bbbbbbbbb"]


def test_free_connections_take_turns() -> None:
    signs = Signs()
    said = said_within(0.35, signs, signs.on("a", 0.01), signs.on("b", 0.01))
    assert [name for _, name in said] == ["a", "b", "a", "b"]


def test_a_beat_that_fails_is_tried_again() -> None:
    signs = Signs()
    said = said_within(0.25, signs, signs.on("a", 0.01, LinkError("lost")))
    assert [time_s for time_s, _ in said] == [0.0, 0.1, 0.2]


def test_no_beat_follows_the_end() -> None:
    signs = Signs()
    assert said_within(0.05, signs, signs.on("a", 0.3), signs.on("b", 0.3)) == [(0.0, "a")]


def test_the_first_beat_may_be_due_after_a_period() -> None:
    signs = Signs()
    said = said_within(0.25, signs, signs.on("a", 0.01), at_once=False)
    assert [time_s for time_s, _ in said] == [0.1, 0.2]
