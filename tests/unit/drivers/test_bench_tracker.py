"""The emulated tracker's driver against a scripted control port."""

import json
from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import LinkTimeoutError, ProtocolError, WrongDeviceError
from catseye.drivers.roles.tracker import Position
from catseye.drivers.tracker.bench_tracker import (
    BenchTracker,
    BenchTrackerSettings,
    ObjectDecoder,
)
from tests.unit.drivers.peers import Peer

IDENTITY = '{"ok": true, "name": "catseye bench EMULATOR", "time_s": 1.5}\n'
POSITION = '{"ok": true, "x_mm": 12.5, "y_mm": -3.25, "u_mm": 0.0075}\n'


class Port:
    def __init__(self) -> None:
        self.identify: list[str] = [IDENTITY]
        self.tracker: list[list[str]] = [[POSITION]]

    def answer(self, data: bytes) -> Iterable[bytes]:
        operation = json.loads(data)["op"]
        lines = self.identify if operation == "identify" else self.tracker.pop(0)
        return [line.encode() for line in lines]


@asynccontextmanager
async def bench(port: Port) -> AsyncIterator[tuple[BenchTracker, Peer]]:
    async with Peer(port.answer, endpoint="memory://control") as peer:
        settings = BenchTrackerSettings(answer_timeout_s=0.1, quiet_s=0.001)
        tracker = BenchTracker(peer.transport, settings)
        yield tracker, peer
        await tracker.close()


async def test_identity_and_axis_position_are_answered() -> None:
    async with bench(Port()) as (tracker, peer):
        identity = await tracker.connect()
        assert (identity.model, identity.simulated) == ("catseye bench EMULATOR", True)
        assert await tracker.locate() == Position(12.5, -3.25, 0.0075)
        assert peer.requests == [b'{"op": "identify"}\n', b'{"op": "tracker"}\n']


@pytest.mark.parametrize(
    ("bench_speed", "own", "noted"),
    [
        ("400", 100.0, True),
        ("1", 50.0, True),
        ("400", 400.0, False),
        ("1.0", 1.0, False),
        ('"fast"', 1.0, False),
    ],
)
async def test_a_bench_speed_mismatch_is_noted(bench_speed: str, own: float, noted: bool) -> None:
    port = Port()
    port.identify = [IDENTITY.replace("}", f', "speed": {bench_speed}}}')]
    async with Peer(port.answer, endpoint="memory://control") as peer:
        settings = BenchTrackerSettings(answer_timeout_s=0.1, quiet_s=0.001)
        tracker = BenchTracker(peer.transport, settings, clock_speed=own)
        await tracker.connect()
        assert [f"start runs with --speed {bench_speed}" in note for note in tracker.notes] == [True] * noted
        await tracker.close()


def test_the_runs_clock_states_its_speed() -> None:
    tracker = BenchTracker.at("tcp://127.0.0.1:1", SystemClock(50.0))
    assert tracker._clock_speed == 50.0  # noqa: SLF001  # nothing is opened, nothing else shows it


@pytest.mark.parametrize("first", ["SSH-2.0-OpenSSH_9.2\r\n", '{"ok": false, "error": "what?"}\n', "[]\n"])
async def test_a_stranger_is_named_by_its_first_bytes(first: str) -> None:
    port = Port()
    port.identify = [first]
    async with bench(port) as (tracker, _):
        with pytest.raises(WrongDeviceError, match=r"memory://control: no emulated bench .* control port"):
            await tracker.connect()


async def test_a_silent_port_is_a_timeout() -> None:
    port = Port()
    port.identify = []
    async with bench(port) as (tracker, _):
        with pytest.raises(LinkTimeoutError, match=r"tracker at memory://control: no answer"):
            await tracker.connect()


async def test_a_lost_answer_is_requested_again_after_healing() -> None:
    port = Port()
    port.tracker = [[], [POSITION]]
    async with bench(port) as (tracker, peer):
        await tracker.connect()
        assert (await tracker.locate()).x_mm == 12.5
        assert peer.requests.count(b'{"op": "identify"}\n') == 2


async def test_an_answer_without_position_is_a_protocol_error() -> None:
    port = Port()
    port.tracker = [['{"ok": false, "error": "no arm"}\n']]
    async with bench(port) as (tracker, _):
        await tracker.connect()
        with pytest.raises(ProtocolError, match=r"no position in .*no arm"):
            await tracker.locate()


@given(cut=st.integers(0, len(POSITION)))
def test_any_split_gives_the_same_object(cut: int) -> None:
    decoder = ObjectDecoder()
    first = decoder.feed(POSITION[:cut].encode())
    assert (first or decoder.feed(POSITION[cut:].encode())) == json.loads(POSITION)


@given(st.lists(st.binary(max_size=40), max_size=6))
def test_garbage_raises_nothing_but_protocol_errors(chunks: list[bytes]) -> None:
    decoder = ObjectDecoder()
    try:
        answers = [decoder.feed(chunk) for chunk in chunks]
    except ProtocolError:
        return
    assert all(answer is None or isinstance(answer, dict) for answer in answers)


def test_an_endless_line_is_refused() -> None:
    decoder = ObjectDecoder()
    assert decoder.feed(b"1" * 65536) is None
    with pytest.raises(ProtocolError, match="does not end"):
        decoder.feed(b"1")


@pytest.mark.parametrize("x_mm", ["NaN", "1e999", f"1{'0' * 400}"])
async def test_a_position_that_is_no_number_is_none(x_mm: str) -> None:
    port = Port()
    port.tracker = [[f'{{"ok": true, "x_mm": {x_mm}, "y_mm": 0.0, "u_mm": 0.1}}\n']]
    async with bench(port) as (tracker, _):
        await tracker.connect()
        with pytest.raises(ProtocolError, match="no position in"):
            await tracker.locate()
