"""What is urgent overtakes what waits, and no link takes more than its share of a turn of the loop."""

import asyncio
import os
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest

from catseye.app.testing.memory import pipe
from catseye.drivers.links.channel import Channel
from catseye.drivers.links.inbox import TURN_BYTES, TURN_S, Inbox
from catseye.drivers.links.record import RecordingTransport
from catseye.drivers.links.tcp import TcpTransport
from catseye.drivers.roles.errors import LinkError

STOP = b"1;1;STOP\r"


@asynccontextmanager
async def connected() -> AsyncIterator[tuple[TcpTransport, socket.socket]]:
    """A link and the socket of the instrument behind it."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        link = TcpTransport("127.0.0.1", listener.getsockname()[1])
        await link.open()
        peer = listener.accept()[0]
        with peer:
            yield link, peer
        await link.close()


def opened(ours: socket.socket) -> Channel:
    ours.setblocking(False)
    return Channel(ours.fileno(), "test://channel", ended="gone", broken=str)


async def test_urgent_bytes_are_with_the_system_at_once() -> None:
    async with connected() as (link, peer):
        peer.setblocking(False)
        link.send_urgent(STOP, cut=b"\r")
        assert peer.recv(100) == STOP
        assert os.fstat(link.fileno())


async def test_urgent_bytes_cut_a_request_that_is_half_written() -> None:
    ours, peer = socket.socketpair()
    with ours, peer:
        channel = opened(ours)
        writing = asyncio.create_task(channel.write(b"x" * (1 << 22)))
        await asyncio.sleep(0)
        with pytest.raises(LinkError, match="takes no bytes now"):
            channel.send_urgent(STOP, b"\r")
        with pytest.raises(LinkError, match="dropped for something urgent"):
            await writing
        came = b""
        peer.setblocking(False)
        while not came.endswith(STOP):
            came += peer.recv(1 << 16)
            await asyncio.sleep(0)
        assert came.strip(b"x") == b"\r" + STOP
        channel.close(LinkError("over"))


async def test_a_second_urgent_request_takes_the_place_of_the_first() -> None:
    ours, peer = socket.socketpair()
    with ours, peer:
        channel = opened(ours)
        writing = asyncio.create_task(channel.write(b"x" * (1 << 22)))
        await asyncio.sleep(0)
        for _ in range(3):
            with pytest.raises(LinkError, match="takes no bytes now"):
                channel.send_urgent(STOP, b"\r")
        with pytest.raises(LinkError):
            await writing
        assert channel._unsent == b"\r" + STOP  # noqa: SLF001  # what waits for room
        channel.close(LinkError("over"))


async def test_nothing_urgent_goes_over_a_closed_link() -> None:
    async with connected() as (link, _):
        await link.close()
        with pytest.raises(LinkError, match="was closed"):
            link.send_urgent(STOP)
        with pytest.raises(LinkError, match="was closed"):
            link.fileno()


async def test_closing_ends_a_connection_whose_descriptor_was_duplicated() -> None:
    async with connected() as (link, peer):
        duplicate = os.dup(link.fileno())
        await link.close()
        assert peer.recv(10) == b""
        os.close(duplicate)


async def test_what_is_urgent_stands_in_the_record() -> None:
    near, far = pipe()
    seen: list[tuple[str, bytes]] = []
    link = RecordingTransport(near, lambda direction, data: seen.append((direction, data)))
    await far.open()
    await link.open()
    link.send_urgent(STOP)
    assert (seen, far.waiting()) == ([("tx", STOP)], STOP)


async def test_a_flood_gets_one_share_of_each_turn() -> None:
    ours, peer = socket.socketpair()
    with ours, peer:
        channel = opened(ours)
        peer.setblocking(False)
        flood = b"\r\n" * 50_000
        sent = peer.send(flood)
        assert sent > 3 * TURN_BYTES
        came = 0
        for _ in range(3):
            taken = 0
            while chunk := channel.waiting():
                taken += len(chunk)
            assert 0 < taken <= TURN_BYTES
            came += taken
            await asyncio.sleep(0)
        assert came <= 3 * TURN_BYTES
        channel.close(LinkError("over"))


async def test_a_reader_of_a_flood_lets_the_loop_turn() -> None:
    inbox = Inbox(1 << 20)
    for _ in range(100):
        inbox.put(bytes(TURN_BYTES // 2))
    turns = 0

    async def count() -> None:
        nonlocal turns
        while True:
            turns += 1
            await asyncio.sleep(0)

    counting = asyncio.create_task(count())
    for _ in range(100):
        assert await inbox.read()
    assert turns >= 49
    counting.cancel()


async def test_a_turn_that_takes_long_is_spent(monkeypatch: pytest.MonkeyPatch) -> None:
    inbox = Inbox(1 << 20)
    inbox.put(b"a")
    inbox.put(b"b")
    loop = asyncio.get_running_loop()
    assert inbox.take() == b"a"
    later_s = loop.time() + 2 * TURN_S
    with monkeypatch.context() as patch:
        patch.setattr(loop, "time", lambda: later_s)
        assert inbox.take() == b""
    await asyncio.sleep(0)
    assert inbox.take() == b"b"
