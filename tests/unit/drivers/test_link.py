"""One request at a time; a link that is out of step is healed before it is used."""

import asyncio
from collections.abc import Iterable

import pytest

from catseye.drivers.links.cancelling import uninterrupted
from catseye.drivers.links.healing import HEALS, Repeat
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.record import RecordingTransport
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.device import Entry
from catseye.drivers.roles.errors import LinkError, LinkTimeoutError, ProtocolError
from tests.patience import until
from tests.unit.drivers.peers import Peer

QUIET_S = 0.001
SHORT_S = 0.005
LONG_S = 5.0


class Line:
    """Decoder of a line that ends in LF; a first byte `!` is garbage, a last byte `.` may be the end."""

    def __init__(self) -> None:
        self._buffer = b""
        self.rest = b""

    @property
    def may_end(self) -> bool:
        return self._buffer.endswith(b".")

    def feed(self, data: bytes) -> str | None:
        self._buffer += data
        if self._buffer.startswith(b"!"):
            raise ProtocolError("garbage")
        line, end, self.rest = self._buffer.partition(b"\n")
        return line.decode() if end else None

    def end(self) -> str:
        return self._buffer.decode()


class Slow:
    """A device that answers `slow` only after the next question, as a busy controller does."""

    def __init__(self) -> None:
        self.owed: list[bytes] = []

    def answer(self, data: bytes) -> Iterable[bytes]:
        if data == b"slow?":
            self.owed.append(b"answer to slow\n")
            return []
        answers = [*self.owed, b"answer to " + data.rstrip(b"?") + b"\n"]
        self.owed = []
        return answers

    def hang_up(self) -> None:
        self.owed = []


def echo(data: bytes) -> Iterable[bytes]:
    return [b"answer to " + data.rstrip(b"?") + b"\n"]


def make(transport: Transport) -> RequestLink:
    """Return a link that greets by asking `who?`."""

    async def greet() -> None:
        reply = await link.exchange(b"who?", Line(), LONG_S)
        if reply != "answer to who":
            raise ProtocolError(f"a stranger: {reply}")

    link = RequestLink(transport, name="device", greet=greet, quiet_s=QUIET_S)
    return link


async def test_answers_belong_to_their_questions() -> None:
    async with Peer(echo) as peer:
        link = make(peer.transport)
        await link.open()
        replies = await asyncio.gather(*(link.request(f"{i}?".encode(), Line, LONG_S) for i in range(5)))
        await link.close()
    assert replies == [f"answer to {i}" for i in range(5)]
    assert peer.requests == [b"who?", b"0?", b"1?", b"2?", b"3?", b"4?"]


async def test_a_bare_exchange_gets_the_previous_answer() -> None:
    async with Peer(Slow().answer) as peer:
        link = make(peer.transport)
        await link.open()
        with pytest.raises(LinkTimeoutError):
            await link.request(b"slow?", Line, SHORT_S)
        # `exchange` is the bare conversation, without the care that `request` takes.
        assert await link.exchange(b"speed?", Line(), LONG_S) == "answer to slow"
        await link.close()


async def test_a_timeout_is_healed_by_reconnecting_and_greeting() -> None:
    slow = Slow()
    async with Peer(slow.answer, on_hang_up=slow.hang_up) as peer:
        link = make(peer.transport)
        await link.open()
        with pytest.raises(
            LinkTimeoutError, match=r"device at memory://device: no answer to b'slow\?'.*no byte"
        ):
            await link.request(b"slow?", Line, SHORT_S)
        assert await link.request(b"speed?", Line, LONG_S) == "answer to speed"
        assert (link.heal_count, link.doubt) == (1, "")
        await link.close()
    assert peer.requests == [b"who?", b"slow?", b"who?", b"speed?"]


async def test_heals_are_counted_for_each_endpoint() -> None:
    slow = Slow()
    async with Peer(slow.answer, on_hang_up=slow.hang_up) as peer:
        link = make(peer.transport)
        before = HEALS[link.where]
        await link.open()
        with pytest.raises(LinkTimeoutError):
            await link.request(b"slow?", Line, SHORT_S)
        await link.request(b"speed?", Line, LONG_S)
        await link.close()
    assert HEALS[link.where] - before == 1


async def test_the_greeting_detects_a_late_serial_answer() -> None:
    """On a serial line the answer comes although the port was opened anew."""
    async with Peer(Slow().answer) as peer:
        link = make(peer.transport)
        await link.open()
        with pytest.raises(LinkTimeoutError):
            await link.request(b"slow?", Line, SHORT_S)
        with pytest.raises(ProtocolError, match="a stranger: answer to slow"):
            await link.request(b"speed?", Line, LONG_S)
        assert link.doubt
        assert await link.request(b"speed?", Line, LONG_S) == "answer to speed"
        await link.close()


async def test_cancellation_poisons_the_link_too() -> None:
    slow = Slow()
    async with Peer(slow.answer, on_hang_up=slow.hang_up) as peer:
        link = make(peer.transport)
        await link.open()
        task = asyncio.create_task(link.request(b"slow?", Line, LONG_S))
        await until(lambda: b"slow?" in peer.requests)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        assert "slow" in link.doubt
        assert await link.request(b"speed?", Line, LONG_S) == "answer to speed"
        await link.close()


async def test_garbage_poisons_the_link_and_is_quoted() -> None:
    async with Peer(lambda data: [b"!\x00\xff"] if data == b"bad?" else echo(data)) as peer:
        link = make(peer.transport)
        await link.open()
        with pytest.raises(
            ProtocolError, match=r"device at memory://device: garbage; last bytes b'!\\x00\\xff'"
        ):
            await link.request(b"bad?", Line, LONG_S)
        assert await link.request(b"good?", Line, LONG_S) == "answer to good"
        assert link.heal_count == 1
        await link.close()


async def test_unsolicited_bytes_are_counted_and_never_taken_for_an_answer() -> None:
    async with Peer(echo) as peer:
        link = make(peer.transport)
        await link.open()
        await peer.say(b"answer to nothing\n")
        assert await link.request(b"speed?", Line, LONG_S) == "answer to speed"
        assert (link.heal_count, link.discarded_bytes) == (1, len(b"answer to nothing"))
        await link.close()


async def test_surplus_behind_an_answer_makes_the_link_suspicious() -> None:
    async with Peer(lambda data: [b"one\ntwo\n"] if data == b"two?" else echo(data)) as peer:
        link = make(peer.transport)
        await link.open()
        assert await link.request(b"two?", Line, LONG_S) == "one"
        assert "two" in link.doubt
        assert await link.request(b"next?", Line, LONG_S) == "answer to next"
        await link.close()


async def test_a_late_line_end_is_harmless() -> None:
    async with Peer(lambda data: [b"x\n\r\n"] if data == b"x?" else echo(data)) as peer:
        link = make(peer.transport)
        await link.open()
        assert await link.request(b"x?", Line, LONG_S) == "x"
        await peer.say(b"\r\n")
        assert await link.request(b"next?", Line, LONG_S) == "answer to next"
        assert link.heal_count == 0
        await link.close()


async def test_silence_ends_an_answer_that_may_end() -> None:
    async with Peer(lambda data: [b"maybe", b"."] if data == b"m?" else echo(data)) as peer:
        link = make(peer.transport)
        await link.open()
        assert await link.request(b"m?", Line, LONG_S) == "maybe."
        await link.close()


async def test_questions_may_be_asked_twice_on_request() -> None:
    answers = iter([[], [b"second\n"]])
    async with Peer(lambda data: next(answers) if data == b"q?" else echo(data)) as peer:
        link = make(peer.transport)
        await link.open()
        assert await link.request(b"q?", Line, SHORT_S, repeat=Repeat.HARMLESS) == "second"
        await link.close()
    assert peer.requests == [b"who?", b"q?", b"who?", b"q?"]


async def test_commands_are_not_sent_twice() -> None:
    async with Peer(lambda data: [] if data == b"go" else echo(data)) as peer:
        link = make(peer.transport)
        await link.open()
        with pytest.raises(LinkTimeoutError):
            await link.request(b"go", Line, SHORT_S)
        await link.close()
    assert peer.requests.count(b"go") == 1


async def test_a_bound_request_is_not_sent_on_a_poisoned_link() -> None:
    async with Peer(lambda data: [] if data == b"slow?" else echo(data)) as peer:
        link = make(peer.transport)
        await link.open()
        with pytest.raises(LinkTimeoutError):
            await link.request(b"slow?", Line, SHORT_S)
        with pytest.raises(LinkError, match="nothing was sent"):
            await link.request(b"go", Line, LONG_S, repeat=Repeat.BOUND)
        await link.ensure()
        assert await link.request(b"go", Line, LONG_S, repeat=Repeat.BOUND) == "answer to go"
        await link.close()
    assert peer.requests == [b"who?", b"slow?", b"who?", b"go"]


async def test_a_transcript_names_each_healing_with_its_bytes() -> None:
    entries: list[tuple[Entry, bytes]] = []
    async with Peer(lambda data: [b"!\x00"] if data == b"bad?" else echo(data)) as peer:
        link = make(RecordingTransport(peer.transport, lambda *entry: entries.append(entry)))
        await link.open()
        with pytest.raises(ProtocolError):
            await link.request(b"bad?", Line, LONG_S)
        assert await link.request(b"good?", Line, LONG_S) == "answer to good"
        await peer.say(b"late\n")
        assert await link.request(b"more?", Line, LONG_S) == "answer to more"
        await link.close()
    healed = [(place, data.decode()) for place, (entry, data) in enumerate(entries) if entry == "heal"]
    garbage, unasked = healed
    assert garbage == (4, r"the answer to b'bad?' is outstanding; last bytes b'!\x00'")
    assert entries[3] == ("rx", b"!\x00")
    assert "bytes came that nobody asked for: b'late'" in unasked[1]


async def test_a_hang_up_between_requests_is_healed() -> None:
    async with Peer(echo) as peer:
        link = make(peer.transport)
        await link.open()
        await peer.far.close()
        await peer.far.open()
        assert await link.request(b"speed?", Line, LONG_S) == "answer to speed"
        assert link.heal_count == 1
        await link.close()


async def test_an_urgent_send_always_leaves_the_link_in_doubt() -> None:
    def answer(data: bytes) -> Iterable[bytes]:
        return [] if data == b"wait?" else echo(data)

    async with Peer(answer) as peer:
        link = make(peer.transport)
        await link.open()
        task = asyncio.create_task(link.request(b"wait?", Line, LONG_S))
        await until(lambda: b"wait?" in peer.requests)
        link.send_urgent(b"STOP", cut=b"\n")
        assert await task == "answer to STOP"
        assert "STOP" in link.doubt
        await link.close()


async def test_an_urgent_send_during_the_greeting_fails_it() -> None:
    """Its answer may come late and would be taken for that to the first request."""
    slow = Slow()
    urgent = iter([True])

    async def greet() -> None:
        asking = asyncio.create_task(link.exchange(b"who?", Line(), LONG_S))
        await asyncio.sleep(0)
        if next(urgent, False):
            link.send_urgent(b"slow?", cut=b"\n")
        assert await asking == "answer to who"
        await link.exchange(b"what?", Line(), LONG_S)

    async with Peer(slow.answer, on_hang_up=slow.hang_up) as peer:
        link = RequestLink(peer.transport, name="device", greet=greet, quiet_s=QUIET_S)
        with pytest.raises(LinkError, match="put in past"):
            await link.open()
        await link.open()
        assert await link.request(b"speed?", Line, LONG_S) == "answer to speed"
        await link.close()
    assert peer.requests == [b"who?", b"slow?", b"who?", b"what?", b"speed?"]


async def test_a_closed_link_stays_closed() -> None:
    async with Peer(echo) as peer:
        link = make(peer.transport)
        with pytest.raises(LinkError, match="not connected: connect first"):
            await link.request(b"q?", Line, LONG_S)
        await link.open()
        await link.close()
        await link.close()
        with pytest.raises(LinkError, match="not connected: connect first"):
            await link.request(b"q?", Line, LONG_S)


async def test_a_greeting_that_fails_closes_the_link() -> None:
    async with Peer(lambda _: [b"somebody else\n"]) as peer:
        link = make(peer.transport)
        with pytest.raises(ProtocolError, match="a stranger"):
            await link.open()
        assert not peer.transport.is_open


async def test_a_greeting_that_fails_half_way_leaves_no_session() -> None:
    async with Peer(lambda data: [] if data == b"slow?" else echo(data)) as peer:
        refusals = 0

        async def greet() -> None:
            nonlocal refusals
            await link.exchange(b"who?", Line(), LONG_S)
            if peer.hang_ups and not refusals:
                refusals += 1
                raise ProtocolError("no right given")

        link = RequestLink(peer.transport, name="device", greet=greet, quiet_s=QUIET_S)
        await link.open()
        with pytest.raises(LinkTimeoutError):
            await link.request(b"slow?", Line, SHORT_S)
        with pytest.raises(ProtocolError, match="no right given"):
            await link.request(b"speed?", Line, LONG_S)
        assert b"speed?" not in peer.requests
        assert await link.request(b"speed?", Line, LONG_S) == "answer to speed"
        await link.close()


async def test_a_command_without_answer_is_sent() -> None:
    async with Peer(lambda data: [] if data == b"Z" else echo(data)) as peer:
        link = make(peer.transport)
        await link.open()
        await link.send(b"Z", LONG_S)
        assert await link.request(b"speed?", Line, LONG_S) == "answer to speed"
        await link.close()
    assert peer.requests == [b"who?", b"Z", b"speed?"]


@pytest.mark.parametrize("cancelled", [False, True])
async def test_a_command_that_is_half_sent_poisons_the_link(
    cancelled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def stuck(_data: bytes) -> None:
        await asyncio.Event().wait()

    async with Peer(echo) as peer:
        link = make(peer.transport)
        await link.open()
        with monkeypatch.context() as patch:
            patch.setattr(peer.near, "write", stuck)
            if cancelled:
                sending = asyncio.create_task(link.send(b"Z", LONG_S))
                await until(lambda: bool(link.doubt))
                sending.cancel()
                await asyncio.wait({sending})
            else:
                with pytest.raises(LinkTimeoutError, match="b'Z' is not taken within"):
                    await link.send(b"Z", SHORT_S)
        assert link.doubt == "b'Z' may be half sent"
        assert await link.request(b"speed?", Line, LONG_S) == "answer to speed"
        assert (link.heal_count, link.doubt) == (1, "")
        await link.close()


async def test_uninterrupted_work_ends_before_the_cancellation_goes_on() -> None:
    gate, done = asyncio.Event(), []

    async def work() -> None:
        await gate.wait()
        done.append(True)

    task = asyncio.create_task(uninterrupted(work()))
    await asyncio.sleep(0)
    for _ in range(3):
        task.cancel()
        await asyncio.sleep(0)
    assert not task.done()
    gate.set()
    with pytest.raises(asyncio.CancelledError):
        await task
    assert done == [True]


async def test_uninterrupted_work_that_fails_says_so_although_it_was_cancelled() -> None:
    gate = asyncio.Event()

    async def work() -> None:
        await gate.wait()
        raise LinkError("STOP was not taken")

    task = asyncio.create_task(uninterrupted(work()))
    await asyncio.sleep(0)
    task.cancel()
    await asyncio.sleep(0)
    gate.set()
    with pytest.raises(LinkError, match="STOP was not taken"):
        await task


async def test_closing_while_the_link_is_being_opened_leaves_nothing_open(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    may_open = asyncio.Event()

    async def greet() -> None:
        raise AssertionError("nothing is said on a link that was closed")

    async with Peer(echo) as device:
        transport = device.transport
        open_at_once = transport.open

        async def open_slowly() -> None:
            await may_open.wait()
            await open_at_once()

        monkeypatch.setattr(transport, "open", open_slowly)
        link = RequestLink(transport, name="device", greet=greet, quiet_s=QUIET_S)
        opening = asyncio.create_task(link.open())
        await asyncio.sleep(0)
        await link.close()
        may_open.set()
        with pytest.raises(LinkError, match="closed while it was being opened"):
            await opening
        assert not transport.is_open
