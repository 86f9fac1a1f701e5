"""Reading that nobody waits for once the program ends: a long one must not keep Ctrl-Q from ending it."""

import asyncio
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar

_Found = TypeVar("_Found")


async def read_aside(read: Callable[[], _Found]) -> _Found:
    """Return what was read in a thread that ends with the program; whatever writes belongs in `asyncio.to_thread`.

    Args:
        read: changes nothing.
    """
    loop = asyncio.get_running_loop()
    found: asyncio.Future[_Found] = loop.create_future()

    def take(value: _Found) -> None:
        if not found.done():
            found.set_result(value)

    def fail(error: BaseException) -> None:
        if not found.done():
            found.set_exception(error)

    def work() -> None:
        # The loop is closed when the program has ended meanwhile.
        with suppress(RuntimeError):
            try:
                value = read()
            except BaseException as error:  # noqa: BLE001  # belongs to whoever waits
                loop.call_soon_threadsafe(fail, error)
            else:
                loop.call_soon_threadsafe(take, value)

    threading.Thread(target=work, name="catseye reading", daemon=True).start()
    return await found
