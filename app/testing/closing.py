"""Closing a server without losing who has just come."""

import asyncio
from typing import Final

_TURNS_TO_SERVE: Final = 4
"""Turns of the event loop between accepting a connection and serving it; asyncio takes three."""


async def close_server(server: asyncio.Server) -> None:
    """Accept nobody more, let those who were accepted be served, then close.

    A connection that is accepted in the very turn in which its server closes is neither served nor closed by asyncio:
    its socket stays open until the garbage collector finds it.
    """
    loop = asyncio.get_running_loop()
    for listener in server.sockets:
        loop.remove_reader(listener.fileno())
    for _ in range(_TURNS_TO_SERVE):
        await asyncio.sleep(0)
    server.close()
