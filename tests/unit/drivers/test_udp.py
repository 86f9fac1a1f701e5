"""The transport over datagrams, on the real loopback."""

import asyncio
import socket

import pytest

from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.links.udp import UdpTransport
from catseye.drivers.roles.errors import LinkError
from tests.patience import HANG_S, until


def peer() -> tuple[socket.socket, UdpTransport]:
    """Return an instrument's socket and a transport to it."""
    far = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    far.bind(("127.0.0.1", 0))
    return far, UdpTransport("127.0.0.1", far.getsockname()[1])


async def test_a_write_is_a_datagram_and_a_read_returns_one() -> None:
    far, link = peer()
    with far:
        await link.open()
        await link.open()
        await link.write(b"one")
        data, address = far.recvfrom(100)
        assert data == b"one"
        for part in (b"a", b"", b"bc"):
            far.sendto(part, address)
        assert [await link.read(), await link.read()] == [b"a", b"bc"]
        assert link.waiting() == b""
        far.sendto(b"unasked", address)
        assert link.waiting() == b"unasked"
        await link.close()
        await link.close()


async def test_only_the_instrument_is_heard() -> None:
    far, link = peer()
    with far, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        await link.open()
        await link.write(b"x")
        _, address = far.recvfrom(100)
        stranger.sendto(b"foreign", address)
        far.sendto(b"own", address)
        assert await link.read() == b"own"
        await link.close()


async def test_what_nobody_reads_is_bounded_and_counted() -> None:
    far, link = peer()
    with far:
        await link.open()
        await link.write(b"x")
        _, address = far.recvfrom(100)
        for _ in range(40):
            far.sendto(bytes(60_000), address)
            await asyncio.sleep(0)
        await until(lambda: link.lost_datagrams == 40 - 17)
        assert len(await link.read()) == 60_000
        await link.close()


async def test_nobody_there_is_an_error_of_the_link() -> None:
    far, link = peer()
    far.close()
    await link.open()
    await link.write(b"x")
    with pytest.raises(LinkError, match=r"udp://127.0.0.1:\d+: a datagram was refused .*switched on"):
        await asyncio.wait_for(link.read(), HANG_S)
    await link.close()


async def test_a_closed_link_refuses_and_wakes_its_reader() -> None:
    far, link = peer()
    far.close()
    with pytest.raises(LinkError, match="not open: connect first"):
        await link.write(b"x")
    with pytest.raises(LinkError, match="not open: connect first"):
        await link.read()
    await link.open()
    reading = asyncio.create_task(link.read())
    await asyncio.sleep(0)
    await link.close()
    with pytest.raises(LinkError, match="was closed"):
        await reading


async def test_an_unknown_name_is_an_error_of_the_link() -> None:
    with pytest.raises(LinkError, match=r"udp://no-such-host\.invalid:1: cannot be reached"):
        await open_transport("udp://no-such-host.invalid:1").open()
