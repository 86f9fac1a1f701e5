"""How long a test waits for what is sure to come."""

import asyncio
from collections.abc import Callable
from typing import Final

HANG_S: Final = 300.0
"""Whoever has waited so long waits for ever, on whatever machine; no test judges speed by it.

A test as a whole may take `timeout` of pyproject.toml.
"""

JOB_S: Final = 800.0
"""How long a whole demonstration may take, 100 s of a core: a busy machine takes several times as long."""


async def until(condition: Callable[[], bool]) -> None:
    """Let tasks and threads go on until a condition holds that nobody reports."""
    async with asyncio.timeout(HANG_S):
        while not condition():  # noqa: ASYNC110  # no event is set for it
            await asyncio.sleep(0)
