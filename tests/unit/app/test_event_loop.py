"""The loop whose timers wake on time: what it asks the system for, and that it misses nothing meanwhile."""

import asyncio
import select
import socket
from typing import Any

import pytest

from catseye.app import event_loop


def test_short_timers_are_not_rounded_to_milliseconds(monkeypatch: pytest.MonkeyPatch) -> None:
    asked_s: list[float] = []

    def at_once(read: Any, write: Any, other: Any, timeout_s: float) -> tuple[list[int], ...]:
        asked_s.append(timeout_s)
        return select_(read, write, other, timeout_s)

    select_ = select.select
    monkeypatch.setattr(select, "select", at_once)
    event_loop.run(asyncio.sleep(0.0003))
    assert asked_s
    assert max(asked_s) <= 0.0003


def test_what_arrives_ends_a_long_wait() -> None:
    async def heard() -> bytes:
        near, far = socket.socketpair()
        with near, far:
            near.setblocking(False)
            loop = asyncio.get_running_loop()
            loop.call_soon(far.send, b"now")
            async with asyncio.timeout(3600.0):
                return await loop.sock_recv(near, 3)

    assert event_loop.run(heard()) == b"now"


def test_another_threads_call_ends_a_long_wait() -> None:
    async def called() -> int:
        async with asyncio.timeout(3600.0):
            return await asyncio.to_thread(lambda: 7)

    assert event_loop.run(called()) == 7


def test_an_error_ends_the_run() -> None:
    async def failing() -> None:
        raise ValueError("as it is")

    with pytest.raises(ValueError, match="as it is"):
        event_loop.run(failing())
