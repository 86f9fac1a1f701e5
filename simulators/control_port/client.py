"""Asking the control port of an emulated bench that runs elsewhere."""

import asyncio
import socket
from typing import TypeVar

from catseye.simulators.control_port.exchange import Answer, Request

A = TypeVar("A", bound=Answer)

_LONGEST_ANSWER_BYTES = 1 << 22


async def ask(endpoint: str, request: Request[A], limit_s: float = 10.0) -> A:
    """Put a request to a control port, over a connection of its own.

    Args:
        endpoint: of the control port, `tcp://host:port`.
        limit_s: longest real time.

    Raises:
        RefusedRequestError: the bench refused the request.
        OSError: nobody answers there; TimeoutError: not in time.
        ValueError: what came is no answer.
    """
    async with asyncio.timeout(limit_s):
        reader, writer = await asyncio.open_connection(*_address(endpoint), limit=_LONGEST_ANSWER_BYTES)
        try:
            writer.write(request.encode())
            return request.decode(await reader.readline())
        finally:
            writer.close()
            await writer.wait_closed()


def ask_blocking(endpoint: str, request: Request[A], limit_s: float = 10.0) -> A:
    """Put a request to a control port by a blocking call; see `ask`."""
    with socket.create_connection(_address(endpoint), timeout=limit_s) as link:
        link.sendall(request.encode())
        with link.makefile("rb") as answers:
            return request.decode(answers.readline())


def _address(endpoint: str) -> tuple[str, int]:
    host, _, port = endpoint.removeprefix("tcp://").rpartition(":")
    return host.strip("[]"), int(port)
