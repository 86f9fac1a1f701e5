"""When a program in a test terminal has done what it was asked to do.

Textual's own way sleeps until the process takes no computing time for 20 ms, twice a key: most of a test's time, and
a guess on a busy machine. Here the event loop itself says that nothing is left to be done.
"""

import asyncio
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import process_time
from typing import Any, Final

import pytest
from textual import app, pilot

_SOON_S: Final = 0.02
"""A timer that is due within it belongs to what is under way, as that which paints does."""

_TIMERS_S: Final = 0.2
"""Who is woken again and again is not waited for any longer."""

_IDLE: Final = 0.05
"""Share of computing time below which threads wait for something."""

_under_way: set[asyncio.Future[Any]] = set()


async def until_idle(min_sleep: float = 0.0, max_sleep: float = 1.0) -> None:
    """Wait until the event loop has nothing to do and threads have done their work, or wait themselves.

    Args:
        min_sleep: at least so long, s.
        max_sleep: at most so long for threads, s.
    """
    loop = asyncio.get_running_loop()
    began_s = loop.time()
    await asyncio.sleep(min_sleep)
    while True:
        await _until_nothing_is_ready(loop)
        due_s = min(_due_s(loop), default=began_s + _TIMERS_S)
        if due_s < min(loop.time() + _SOON_S, began_s + _TIMERS_S):
            await asyncio.sleep(due_s - loop.time())
        elif loop.time() > began_s + max_sleep or not await _thread_is_done(loop):
            return


async def _until_nothing_is_ready(loop: Any) -> None:
    quiet = 0
    # Once more: what has come over a socket meanwhile is seen in the next round.
    while quiet < 2:
        await asyncio.sleep(0)
        quiet = 0 if loop._ready else quiet + 1  # noqa: SLF001  # asyncio does not say whether it has something to do


def _due_s(loop: Any) -> Iterator[float]:
    return (timer.when() for timer in loop._scheduled if not timer.cancelled())  # noqa: SLF001  # nor when


async def _thread_is_done(loop: asyncio.AbstractEventLoop) -> bool:
    """Wait while threads compute; return whether one has done its work."""
    mine = {each for each in _under_way if each.get_loop() is loop}
    while mine:
        before_s = process_time()
        done, _ = await asyncio.wait(mine, timeout=_SOON_S, return_when=asyncio.FIRST_COMPLETED)
        if done:
            return True
        if process_time() - before_s < _IDLE * _SOON_S:
            return False
    return False


@contextmanager
def loop_says_when_idle() -> Iterator[None]:
    """Have Textual's programs in tests wait for the event loop."""
    run_in_executor = asyncio.BaseEventLoop.run_in_executor

    def noted(
        self: asyncio.BaseEventLoop, executor: Any, func: Callable[..., Any], *args: Any
    ) -> asyncio.Future[Any]:
        future = run_in_executor(self, executor, func, *args)
        _under_way.add(future)
        future.add_done_callback(_under_way.discard)
        return future

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(asyncio.BaseEventLoop, "run_in_executor", noted)
        for module in (app, pilot):
            patch.setattr(module, "wait_for_idle", until_idle)
        yield
