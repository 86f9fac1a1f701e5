"""Blocking work beside the loop, in a thread that nobody has to wait for."""

import asyncio
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar

T = TypeVar("T")


async def aside(work: Callable[[], T]) -> T:
    """Do blocking work in a thread of its own, and return its result or raise its error.

    Unlike a thread of the loop's pool it takes no place from the work of others, and a disk that never answers keeps
    neither them nor the end of the process waiting.
    """
    loop = asyncio.get_running_loop()
    done: asyncio.Future[T] = loop.create_future()

    def succeeded(result: T) -> None:
        if not done.done():
            done.set_result(result)

    def failed(error: Exception) -> None:
        if not done.done():
            done.set_exception(error)

    def run() -> None:
        # The loop may have ended meanwhile; then nobody wants to know.
        with suppress(RuntimeError):
            try:
                result = work()
            except Exception as error:  # noqa: BLE001  # is raised where the result is awaited
                loop.call_soon_threadsafe(failed, error)
            else:
                loop.call_soon_threadsafe(succeeded, result)

    threading.Thread(target=run, daemon=True).start()
    return await done
