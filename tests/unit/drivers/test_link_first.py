"""A device that another client left sending by itself is silenced before the link is drained."""

import asyncio
from collections.abc import Iterable

import pytest

from catseye.drivers.links.link import RequestLink
from catseye.drivers.roles.errors import LinkError, LinkTimeoutError
from tests.unit.drivers.peers import Peer
from tests.unit.drivers.test_link import LONG_S, QUIET_S, Line, echo
from tests.unit.drivers.virtual_time import run

_PERIOD_S = QUIET_S / 2


class Chatty:
    """Sends until a command stops it, and again after each hang-up."""

    def __init__(self) -> None:
        self.talks = True

    def answer(self, data: bytes) -> Iterable[bytes]:
        if data == b"stop":
            self.talks = False
            return [b"stopped\n"]
        return echo(data)

    def hang_up(self) -> None:
        self.talks = True

    async def talk(self, peer: Peer) -> None:
        while True:
            if self.talks:
                await peer.say(b"1.234567 mm\n")
            await asyncio.sleep(_PERIOD_S)


async def _ask(first: bytes) -> tuple[list[str], list[bytes]]:
    """Open the link to a chatty device, ask, break the link, ask again; return answers and requests."""
    chatty = Chatty()
    async with Peer(chatty.answer, on_hang_up=chatty.hang_up) as peer:
        link = RequestLink(peer.transport, name="device", greet=_nothing, first=first, quiet_s=QUIET_S)
        talking = asyncio.create_task(chatty.talk(peer))
        try:
            await link.open()
            answers = [await link.request(b"one?", Line, LONG_S)]
            link.distrust("a test says so")
            answers.append(await link.request(b"two?", Line, LONG_S))
        finally:
            talking.cancel()
            await asyncio.wait({talking})
            await link.close()
        return answers, peer.requests


async def _nothing() -> None:
    """Greet nobody."""


def test_a_first_command_silences_it_after_each_opening() -> None:
    answers, requests = run(_ask(b"stop"))
    assert answers == ["answer to one", "answer to two"]
    assert requests == [b"stop", b"one?", b"stop", b"two?"]


def test_without_one_the_link_never_falls_quiet() -> None:
    with pytest.raises(LinkError, match="bytes keep coming"):
        run(_ask(b""))


def test_a_first_command_that_is_not_taken_times_out(monkeypatch: pytest.MonkeyPatch) -> None:
    async def opened() -> None:
        async with Peer(echo) as peer:
            link = RequestLink(peer.transport, name="device", greet=_nothing, first=b"stop", quiet_s=QUIET_S)
            monkeypatch.setattr(peer.transport, "write", lambda _data: asyncio.sleep(1e9))
            await link.open()

    with pytest.raises(LinkTimeoutError, match="stop' is not taken"):
        run(opened())
