"""An event loop in a thread of its own, for emulators that serve a test while the test itself is busy."""

import asyncio
import threading
from collections.abc import Coroutine
from types import TracebackType
from typing import Any, Self, TypeVar

T = TypeVar("T")

_LONGEST_S = 30.0


class LoopThread:
    """Use it as a context: the loop runs inside; at the end the thread is gone and the loop closed."""

    def __init__(self, name: str) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name=name, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(_LONGEST_S)
        self._loop.close()

    def run(self, work: Coroutine[Any, Any, T]) -> T:
        """Run a coroutine in the loop and return its result; the caller's thread waits.

        Raises:
            TimeoutError: it did not end within half a minute.
        """
        return asyncio.run_coroutine_threadsafe(work, self._loop).result(_LONGEST_S)
