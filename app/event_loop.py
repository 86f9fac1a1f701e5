"""The event loop of programs that keep time: its timers wake to a tenth of a millisecond.

Those of asyncio wake up to a millisecond late, since epoll takes whole milliseconds. Whoever has to be more exact
waits out the last stretch without a timer, which keeps a core busy: with a bench at several hundred times real speed,
whose waits are that short, for as long as it runs.
"""

import asyncio
import select
import selectors
from collections.abc import Coroutine
from typing import Any, TypeVar

T = TypeVar("T")


class FineTimerLoop(asyncio.SelectorEventLoop):
    """Wakes on time.

    Attributes:
        timer_step_s: by how much a timer may be late on an idle machine, s; whoever waits looks for it.
    """

    timer_step_s = 0.0001

    def __init__(self) -> None:
        super().__init__(_FineSelector())


def run(work: Coroutine[Any, Any, T]) -> T:
    """Run a coroutine to its end, as asyncio.run does, on such a loop."""
    with asyncio.Runner(loop_factory=FineTimerLoop) as runner:
        return runner.run(work)


class _FineSelector(selectors.EpollSelector):
    """Waits in microseconds for what epoll has, and then asks it without waiting."""

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        """Return what is ready, as any selector does."""
        if timeout is not None and timeout > 0.0:
            select.select([self.fileno()], [], [], timeout)
            timeout = 0.0
        return super().select(timeout)
