"""Reading aside: its value, its error, and an end of the program that does not wait for it."""

import asyncio
import threading

import pytest

from catseye.app.tui.aside import read_aside


async def test_what_was_read_is_returned() -> None:
    assert await read_aside(lambda: threading.current_thread().name) == "catseye reading"


async def test_an_error_is_raised_where_it_is_waited_for() -> None:
    def fails() -> None:
        raise OSError("no such file")

    with pytest.raises(OSError, match="no such file"):
        await read_aside(fails)


def test_a_loop_ends_while_something_is_read() -> None:
    """As at Ctrl-Q: `asyncio.run` waits for threads of its own."""
    begun, released, waited = threading.Event(), threading.Event(), []

    def long() -> None:
        begun.set()
        waited.append(released.wait(20.0))

    async def quits() -> None:
        reading = asyncio.ensure_future(read_aside(long))
        await asyncio.sleep(0)
        assert begun.wait(20.0)
        reading.cancel()

    asyncio.run(quits())
    assert waited == []
    released.set()
