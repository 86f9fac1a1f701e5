"""A device that has just dropped its connections may refuse new ones for a moment."""

import asyncio
from collections.abc import Awaitable, Callable

import pytest

from catseye.app.testing.memory import MemoryTransport
from catseye.drivers.links.healing import REOPEN_S, Repeat
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.stream import StreamLink
from catseye.drivers.roles.errors import LinkError, UnreachableError
from tests.unit.drivers.peers import Peer, StepClock
from tests.unit.drivers.test_healing import Bytes, link_to, scripted
from tests.unit.drivers.test_link import Line
from tests.unit.drivers.virtual_time import run


async def nothing() -> None:
    """Greet nobody."""


def refuse_for(transport: MemoryTransport, duration_s: float, patch: pytest.MonkeyPatch) -> None:
    """Have a transport refuse to be opened for a while."""
    loop = asyncio.get_running_loop()
    until_s, opened = loop.time() + duration_s, transport.open

    async def open_late() -> None:
        if loop.time() < until_s:
            raise LinkError("connection refused")
        await opened()

    patch.setattr(transport, "open", open_late)


def with_link(work: Callable[[RequestLink, Peer], Awaitable[None]]) -> None:
    """Do something with an open link to a device that answers."""

    async def linked() -> None:
        async with Peer(scripted()) as peer:
            link = link_to(peer.near, named=False)
            await link.open()
            await work(link, peer)
            await link.close()

    run(linked())


@pytest.mark.parametrize("repeat", [Repeat.HARMLESS, Repeat.NEVER])
def test_a_link_refused_for_a_moment_is_opened_again(repeat: Repeat, monkeypatch: pytest.MonkeyPatch) -> None:
    async def asked(link: RequestLink, peer: Peer) -> None:
        refuse_for(peer.near, 1.5, monkeypatch)
        await peer.near.close()
        assert await link.request(b"q?", Line, 1.0, repeat=repeat) == "right"
        assert peer.requests == [b"who?", b"who?", b"q?"]

    with_link(asked)


def test_a_persistently_refused_link_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    async def asked(link: RequestLink, peer: Peer) -> None:
        loop = asyncio.get_running_loop()
        refuse_for(peer.near, 60.0, monkeypatch)
        await peer.near.close()
        began_s = loop.time()
        with pytest.raises(UnreachableError, match="refused"):
            await link.request(b"q?", Line, 1.0, repeat=Repeat.HARMLESS)
        assert loop.time() - began_s <= REOPEN_S

    with_link(asked)


def test_the_first_connection_is_refused_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    async def opened() -> None:
        async with Peer(scripted()) as peer:
            refuse_for(peer.near, 60.0, monkeypatch)
            with pytest.raises(UnreachableError, match="refused"):
                await link_to(peer.near).open()
            assert asyncio.get_running_loop().time() == 0.0

    run(opened())


def test_closing_ends_the_attempts_to_open_a_link_again(monkeypatch: pytest.MonkeyPatch) -> None:
    async def closed(link: RequestLink, peer: Peer) -> None:
        loop = asyncio.get_running_loop()
        refuse_for(peer.near, 60.0, monkeypatch)
        await peer.near.close()
        asking = asyncio.create_task(link.request(b"q?", Line, 1.0))
        await asyncio.sleep(0.5)
        await link.close()
        with pytest.raises(LinkError):
            await asking
        assert loop.time() < 0.7

    with_link(closed)


def streaming(transport: MemoryTransport, greet: Callable[[], Awaitable[None]] = nothing) -> StreamLink[int]:
    """Return a link to an instrument that sends by itself."""
    return StreamLink(
        transport,
        StepClock(),
        name="display",
        decoder=Bytes,
        take=lambda _frame, _time_s: None,
        greet=greet,
    )


def test_a_stream_refused_for_a_moment_is_opened_again(monkeypatch: pytest.MonkeyPatch) -> None:
    async def streamed() -> None:
        async with Peer(scripted()) as peer:
            link = streaming(peer.near)
            await link.open()
            refuse_for(peer.near, 1.5, monkeypatch)
            await peer.near.close()
            await link.ensure()
            assert peer.near.is_open
            await link.close()

    run(streamed())


def test_a_stream_closed_while_it_is_opened_again_stays_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    async def streamed() -> None:
        async with Peer(scripted()) as peer:
            greeted = 0

            async def greet() -> None:
                nonlocal greeted
                greeted += 1

            link = streaming(peer.near, greet)
            await link.open()
            await peer.near.close()
            go_on, opened = asyncio.Event(), peer.near.open

            async def open_slowly() -> None:
                await go_on.wait()
                await opened()

            monkeypatch.setattr(peer.near, "open", open_slowly)
            before = asyncio.all_tasks()
            healing = asyncio.create_task(link.ensure())
            await asyncio.sleep(1.0)
            await link.close()
            go_on.set()
            with pytest.raises(LinkError, match="closed while it was being opened"):
                await healing
            assert not peer.near.is_open
            assert greeted == 1
            assert asyncio.all_tasks() <= before

    run(streamed())
