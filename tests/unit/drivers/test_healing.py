"""What is harmless is asked again; what must not be is not; a link that loses too much is given up."""

import asyncio
from collections.abc import Callable, Iterable, Iterator

import pytest

from catseye.app.testing.memory import MemoryTransport
from catseye.drivers.links.healing import ATTEMPTS, Losses, Repeat, repeated
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.stream import MOST_BYTES_A_SECOND, StreamLink
from catseye.drivers.links.transport import Transport, WrappedTransport
from catseye.drivers.roles.errors import LinkError, LinkTimeoutError, ProtocolError, UnreachableError
from tests.unit.drivers.peers import Peer, StepClock
from tests.unit.drivers.test_link import Line

QUIET_S = 0.001
SHORT_S = 0.005
LONG_S = 5.0


class Time:
    """Real time as a test has it."""

    def __init__(self) -> None:
        self.now_s = 50.0

    def __call__(self) -> float:
        return self.now_s


def link_to(
    transport: Transport, *, named: bool = True, stays_writable: bool = False, quiet_s: float = QUIET_S
) -> RequestLink:
    """A link to a device that reports its name."""

    async def ask_name() -> None:
        if await made.exchange(b"who?", Line(), LONG_S) != "device":
            raise ProtocolError("not the device")

    made = RequestLink(
        transport,
        name="device",
        greet=ask_name,
        identify=ask_name if named else None,
        quiet_s=quiet_s,
        stays_writable=stays_writable,
    )
    return made


def scripted(*answers: Iterable[bytes]) -> Callable[[bytes], Iterable[bytes]]:
    """A device that answers its name, and everything else as listed, then rightly."""
    left: Iterator[Iterable[bytes]] = iter(answers)
    return lambda data: [b"device\n"] if data == b"who?" else next(left, [b"right\n"])


class LateLine(WrappedTransport):
    """A line whose device does not notice that it was opened again, and answers a moment after."""

    def __init__(self, inner: MemoryTransport, far: MemoryTransport) -> None:
        super().__init__(inner)
        self._far = far
        self.late = b""

    async def open(self) -> None:
        await super().open()
        self.say_soon()

    def say_soon(self) -> None:
        late, self.late = self.late, b""
        if late:
            asyncio.get_running_loop().call_soon(self._far.send_urgent, late)


@pytest.mark.parametrize("named", [True, False], ids=["in place", "opened again"])
async def test_an_answer_that_comes_while_healing_is_thrown_away(named: bool) -> None:
    async with Peer(scripted([])) as peer:
        line = LateLine(peer.near, peer.far)
        link = link_to(line, named=named)
        await link.open()
        with pytest.raises(LinkTimeoutError):
            await link.request(b"slow?", Line, SHORT_S)
        line.late = b"the slow answer\n"
        if named:
            line.say_soon()
        assert await link.request(b"next?", Line, LONG_S) == "right"
        await link.close()
    assert peer.requests == [b"who?", b"slow?", b"who?", b"next?"]


class Chatter(WrappedTransport):
    """A line on which bytes never end."""

    def __init__(self, inner: MemoryTransport, chunk: bytes) -> None:
        super().__init__(inner)
        self._chunk = chunk

    async def read(self) -> bytes:
        await asyncio.sleep(0)
        return self._chunk


@pytest.mark.parametrize("chunk", [b"x" * 4096, b"x"], ids=["much", "little by little"])
async def test_an_endless_flood_is_not_drained_for_ever(
    monkeypatch: pytest.MonkeyPatch, chunk: bytes
) -> None:
    monkeypatch.setattr("catseye.drivers.links.link._DRAIN_TIMEOUT_S", 0.05)
    async with Peer(scripted([])) as peer:
        # So long that no busy machine takes a pause between two chunks for the end.
        link = link_to(Chatter(peer.near, chunk), quiet_s=LONG_S)
        async with asyncio.timeout(LONG_S):
            with pytest.raises(UnreachableError, match="bytes keep coming without a request"):
                await link.open()
    assert peer.requests == []


SPOILT = pytest.mark.parametrize(
    "answer", [[], [b"!garbled\n"], [b"right\nright\n"]], ids=["lost", "garbled", "doubled"]
)


@SPOILT
async def test_a_spoilt_answer_heals_on_the_open_link(answer: Iterable[bytes]) -> None:
    async with Peer(scripted(answer)) as peer:
        link = link_to(peer.transport)
        await link.open()
        for _ in range(2):
            assert await link.request(b"q?", Line, 0.05, repeat=Repeat.HARMLESS) == "right"
        assert (link.heal_count, peer.hang_ups) == (1, 0)
        await link.close()


@SPOILT
async def test_without_a_name_the_link_is_opened_again(answer: Iterable[bytes]) -> None:
    async with Peer(scripted(answer)) as peer:
        link = link_to(peer.transport, named=False)
        await link.open()
        for _ in range(2):
            assert await link.request(b"q?", Line, 0.05, repeat=Repeat.HARMLESS) == "right"
        assert (link.heal_count, peer.hang_ups) == (1, 1)
        await link.close()


async def test_a_late_answer_is_not_taken_for_the_next() -> None:
    """Answers come in order: behind the name none is owed."""
    owed: list[bytes] = []

    def answer(data: bytes) -> Iterable[bytes]:
        if data == b"late?":
            owed.append(b"late\n")
            return []
        late = [owed.pop()] if owed else []
        return [*late, b"device\n" if data == b"who?" else b"right\n"]

    async with Peer(answer) as peer:
        link = link_to(peer.transport)
        await link.open()
        with pytest.raises(LinkTimeoutError):
            await link.request(b"late?", Line, SHORT_S)
        assert await link.request(b"q?", Line, LONG_S) == "right"
        await link.close()


@pytest.mark.parametrize("repeat", [Repeat.NEVER, Repeat.BOUND])
async def test_what_may_not_be_repeated_goes_out_once(repeat: Repeat) -> None:
    async with Peer(scripted([])) as peer:
        link = link_to(peer.transport)
        await link.open()
        with pytest.raises(LinkTimeoutError):
            await link.request(b"move", Line, SHORT_S, repeat=repeat)
        await link.ensure()
        await link.close()
        assert peer.requests.count(b"move") == 1


async def test_a_device_that_is_gone_is_not_asked_again() -> None:
    calls = 0

    async def work() -> None:
        nonlocal calls
        calls += 1
        raise UnreachableError("nobody there")

    with pytest.raises(UnreachableError):
        await repeated(work, Losses(Time()), "device")
    assert calls == 1


async def test_the_last_attempt_says_what_was_wrong() -> None:
    calls = 0

    async def work() -> None:
        nonlocal calls
        calls += 1
        raise ProtocolError(f"garbage {calls}")

    with pytest.raises(ProtocolError, match=f"garbage {ATTEMPTS}"):
        await repeated(work, Losses(Time()), "device")


@pytest.mark.parametrize(
    ("answered", "lost", "too_many"), [(32, 8, False), (31, 8, True), (0, 7, False), (1000, 200, False)]
)
def test_a_fifth_of_the_answers_may_be_lost(answered: int, lost: int, too_many: bool) -> None:
    losses = Losses(Time())
    for _ in range(answered):
        losses.answered()
    for _ in range(lost):
        losses.lost()
    assert losses.counted == (lost, answered + lost)
    assert losses.too_many is too_many


def test_losses_are_forgotten_after_ten_seconds() -> None:
    time = Time()
    losses = Losses(time)
    for _ in range(20):
        losses.lost()
    time.now_s += 9.0
    assert losses.too_many
    time.now_s += 2.0
    assert losses.counted == (0, 0)


async def test_a_link_that_loses_too_much_is_given_up() -> None:
    losses = Losses(Time())
    for _ in range(7):
        losses.lost()

    async def work() -> None:
        losses.lost()
        raise LinkTimeoutError("no answer")

    with pytest.raises(
        LinkError, match=r"device: 8 of 8 answers within 10 s were lost: the link is given up"
    ):
        await repeated(work, losses, "device")


@pytest.mark.parametrize(("stays_writable", "open_after"), [(True, True), (False, False)])
async def test_a_flooding_link_is_closed_unless_it_carries_stop(
    stays_writable: bool, open_after: bool
) -> None:
    def answer(data: bytes) -> Iterable[bytes]:
        return [b"device\n"] if data == b"who?" else [b"\r\n" * 10_000] * 10

    async with Peer(answer) as peer:
        link = link_to(peer.transport, stays_writable=stays_writable)
        await link.open()
        with pytest.raises(UnreachableError, match="device at memory://device: bytes keep coming"):
            await link.request(b"q?", Empty, LONG_S, repeat=Repeat.HARMLESS)
        assert link.floods
        assert peer.transport.is_open is open_after
        if open_after:
            link.send_urgent(b"STOP", cut=b"\n")
            await link.end_flood()
            assert not peer.transport.is_open
        await link.close()


class Empty(Line):
    """Waits for an answer behind empty lines."""

    def feed(self, data: bytes) -> str | None:
        return super().feed(data.strip(b"\r\n"))


class Bytes:
    """Decoder whose frames are chunks that do not begin with an empty line."""

    def feed(self, data: bytes) -> list[int]:
        return [] if data.startswith(b"\r\n") else [len(data)]


@pytest.mark.parametrize(
    ("chunk", "message"),
    [
        (bytes(MOST_BYTES_A_SECOND // 64), "more than 4000000 bytes come within a second"),
        (b"\r\n" * 8192, "more than 65536 bytes come without a value"),
    ],
    ids=["fast", "empty"],
)
async def test_a_stream_that_floods_is_closed_and_named(chunk: bytes, message: str) -> None:
    async with Peer(lambda _data: []) as peer:

        async def greet() -> None:
            return

        link: StreamLink[int] = StreamLink(
            peer.transport,
            StepClock(),
            name="display",
            decoder=Bytes,
            take=lambda _frame, _time_s: None,
            greet=greet,
        )
        await link.open()
        for _ in range(66):
            await peer.far.write(chunk)
        with pytest.raises(LinkError, match=f"display at memory://device: {message}"):
            await link.wait(lambda: False, LONG_S, "frame")
        assert not peer.transport.is_open
        await link.close()


async def test_an_order_is_repeated_until_acknowledged() -> None:
    acknowledged = asyncio.Event()

    def answer(data: bytes) -> Iterable[bytes]:
        del data
        return [b"ok"] if len(peer.requests) == 3 else []

    async with Peer(answer) as peer:

        async def greet() -> None:
            return

        class Acks:
            def feed(self, data: bytes) -> list[bytes]:
                return [data]

        link: StreamLink[bytes] = StreamLink(
            peer.transport,
            StepClock(),
            name="display",
            decoder=Acks,
            take=lambda _frame, _time_s: acknowledged.set(),
            greet=greet,
        )
        await link.open()
        await link.order(b"clear", acknowledged.is_set, SHORT_S, "acknowledgement")
        assert peer.requests == [b"clear"] * 3
        assert link.heal_count == 0
        await link.close()
