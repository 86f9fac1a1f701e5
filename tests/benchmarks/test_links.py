"""What the link layer costs: a question over the loopback, and how soon STOP is on the wire."""

import asyncio
import statistics
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager

from drivers.endpoint import open_transport
from drivers.melfa import codec
from drivers.melfa.session import Session
from drivers.melfa.settings import MelfaSettings

ROUNDS = 2000
BATCHES = 7
QUESTION = b"1;1;OVRD=10\r"
ANSWER = b"QoK"
OPENED = (
    b"QoK0F;0F;7,0;3,5,A,1E,32,46,64;MB5;PRM;RH-3FRH5515-D;CR75x;MELFA;17-10-06;Ver.S7e;ENG;EMULATOR;1;3;8;"
)


class Fixed(asyncio.Protocol):
    """Answers every segment by the same bytes."""

    def __init__(self, connections: list[asyncio.Transport]) -> None:
        self._connections = connections

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        self._connections.append(transport)

    def data_received(self, data: bytes) -> None:
        self._transport.write(OPENED if b"OPEN" in data else ANSWER)


@asynccontextmanager
async def answering() -> AsyncIterator[int]:
    connections: list[asyncio.Transport] = []
    loop = asyncio.get_running_loop()
    server = await loop.create_server(lambda: Fixed(connections), "127.0.0.1", 0)
    try:
        yield server.sockets[0].getsockname()[1]
    finally:
        server.close()
        for connection in connections:
            connection.abort()
        await asyncio.sleep(0)
        await server.wait_closed()


async def microseconds(ask: Callable[[], Awaitable[object]]) -> float:
    start_s = time.perf_counter()
    for _ in range(ROUNDS):
        await ask()
    return 1e6 * (time.perf_counter() - start_s) / ROUNDS


async def test_a_question_costs_at_most_three_bare_echoes() -> None:
    async with answering() as port:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        session = Session(
            open_transport(f"tcp://127.0.0.1:{port}", sink=lambda _direction, _data: None),
            MelfaSettings(),
            name="robot",
        )
        await session.link.open()

        async def bare() -> bytes:
            writer.write(QUESTION)
            return await reader.read(4096)

        async def ours() -> object:
            return await session.ask("OVRD=10", codec.bare)

        pairs = [(await microseconds(bare), await microseconds(ours)) for _ in range(BATCHES)]
        await session.close()
        writer.close()
        await writer.wait_closed()
    echo_us, ours_us = (statistics.median(column) for column in zip(*pairs, strict=True))
    ratio = ours_us / echo_us
    print(f"\nR-protocol question {ours_us:.0f} µs, bare asyncio echo {echo_us:.0f} µs: {ratio:.2f} times")  # noqa: T201
    assert ratio <= 3.0
