"""STOP and ABORT by every way that leads to an engine."""

import asyncio
from collections.abc import Awaitable
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, TypeVar

from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.tui.engines import EngineProcess, all_engines

if TYPE_CHECKING:
    from catseye.app.service.client import EngineClient

T = TypeVar("T")

StopOp = Literal["stop", "abort"]

ANSWER_S: Final = 1.0
"""A stop acts as its line is read; who has not answered by then may never do."""


async def stop_by_every_way(
    op: StopOp, client: "EngineClient | None", process: EngineProcess | None, root: Path
) -> None:
    """Stop by the connection; without its answer by new ones, and at last by a signal to the engine's process.

    Args:
        client: the connection; None when there is none.
        process: of the engine that is, or was, connected.
        root: folder of all runs; an engine of it that moves an arm is found although nobody here was connected.

    Raises:
        RefusedError: whoever answers has nothing to stop.
        ServiceError: nobody answers; the text says what was done instead.
    """
    from catseye.app.protocol.requests import Plain

    refusal = None
    try:
        if client is not None and await _within(client.request(Plain(op=op))) is not None:
            return
    except RefusedError as error:
        # Another process may have the run.
        refusal = error
    paths = await asyncio.to_thread(all_engines, root)
    answers = await asyncio.gather(*(_ask_alone(path, op) for path in paths))
    if True in answers:
        return
    if refusal is None and process is not None and process.abort():
        raise ServiceError(
            f"the engine does not answer to {op.upper()}; a signal to abort was sent to its process: look at the "
            "arm, and use the emergency stop if it moves"
        )
    if refusal is not None or False in answers:
        raise refusal or RefusedError("no run is under way")
    raise ServiceError("no engine answers: use the emergency stop if the arm moves")


async def _ask_alone(path: Path, op: StopOp) -> bool | None:
    """Ask on a connection of its own; return whether it was done, None when nobody answers."""
    from catseye.app.protocol.message import decode_object
    from catseye.app.protocol.requests import Plain, encode_request

    async def ask() -> bool:
        reader, writer = await asyncio.open_unix_connection(path)
        try:
            writer.write(encode_request(op, Plain(op=op)))
            # No model stands between a STOP and its answer.
            return decode_object(await reader.readline()).get("ok") is True
        finally:
            writer.transport.abort()

    try:
        return await _within(ask())
    except (OSError, ValueError):
        return None


async def _within(answer: Awaitable[T]) -> T | None:
    """Return an answer; None when none comes in time, or the connection is closed."""
    try:
        async with asyncio.timeout(ANSWER_S):
            return await answer
    except (TimeoutError, ServiceError):
        return None
