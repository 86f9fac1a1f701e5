"""Ways of waiting that leave no task behind."""

import asyncio
from collections.abc import Coroutine
from typing import Any, TypeVar

from catseye.drivers.roles.clock import Clock

T = TypeVar("T")


async def together(*actions: Coroutine[Any, Any, T]) -> list[T]:
    """Run actions at the same time and return their results in order.

    Raises:
        Exception: the first failure, when all the others have ended.
    """
    try:
        async with asyncio.TaskGroup() as group:
            tasks = [group.create_task(action) for action in actions]
    except BaseExceptionGroup as failures:
        raise failures.exceptions[0] from None
    return [task.result() for task in tasks]


async def within(clock: Clock, limit_s: float, action: Coroutine[Any, Any, T]) -> T:
    """Run an action for at most a time of the given clock, s.

    Raises:
        TimeoutError: it was not over; it has been cancelled.
    """
    task = asyncio.create_task(action)
    timer = asyncio.create_task(clock.sleep(limit_s))
    try:
        await asyncio.wait({task, timer}, return_when=asyncio.FIRST_COMPLETED)
        if not task.done():
            raise TimeoutError(f"not over after {limit_s:g} s")
        return task.result()
    finally:
        await cancel(task, timer)


async def cancel(*tasks: "asyncio.Task[Any]") -> None:
    """Cancel tasks and wait for their end; their errors are dropped."""
    for task in tasks:
        task.cancel()
    await uncancelled(_ended(*tasks))


async def uncancelled(action: Coroutine[Any, Any, T]) -> T:
    """Run an action to its end even when the caller is cancelled meanwhile; then raise the cancellation."""
    task = asyncio.create_task(action)
    interrupted: asyncio.CancelledError | None = None
    while not task.done():
        try:
            await asyncio.wait({task})
        except asyncio.CancelledError as error:
            interrupted = error
    if interrupted is not None:
        # The caller ends as cancelled; an error of the action must not be reported as unseen.
        await asyncio.gather(task, return_exceptions=True)
        raise interrupted
    return task.result()


async def _ended(*tasks: "asyncio.Task[Any]") -> None:
    await asyncio.gather(*tasks, return_exceptions=True)
