"""Heidenhain ND 28x: bytes of manuals and client, both codecs, the driver on the emulator."""

import contextlib
import math
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.testing.memory import MemoryTransport
from catseye.drivers.heidenhain import codec
from catseye.drivers.heidenhain.nd import HeidenhainNd, NdSettings
from catseye.drivers.roles.errors import ProtocolError, RefusedError, WrongDeviceError
from catseye.simulators.context import EmulationContext
from catseye.simulators.heidenhain.nd import Display
from catseye.simulators.ports.session import Session
from tests.transcripts import heidenhain_nd as transcript
from tests.unit.drivers.interferometers.pairs import new_session, paired, quiet_world
from tests.unit.drivers.peers import Peer, StepClock
from tests.unit.simulators.benches import aimed, driven_mm


def make(transport: MemoryTransport, clock: StepClock, **settings: Any) -> HeidenhainNd:
    return HeidenhainNd(transport, clock, NdSettings(quiet_s=0.001, timeout_s=0.5, **settings))


def parts(data: bytes, cuts: list[int]) -> list[bytes]:
    return [data[a:b] for a, b in pairwise([0, *sorted(cuts), len(data)])]


def talk(session: Session, data: bytes) -> bytes:
    session.feed(data)
    said = b""
    while (answer := session.answer()) is not None:
        assert isinstance(answer, bytes)
        said += answer
    return said


@pytest.fixture
def world() -> EmulationContext:
    return quiet_world()


@pytest.fixture
def session(world: EmulationContext) -> Session:
    return new_session(world, "heidenhain-nd")


@pytest.mark.parametrize(("text", "data"), transcript.COMMANDS.items())
def test_commands_are_framed_as_in_the_manual(text: str, data: bytes) -> None:
    assert codec.command(text) == data


@given(st.lists(st.integers(0, len(transcript.IDENTITY)), max_size=5))
def test_any_cut_of_a_reply_gives_the_same_lines(cuts: list[int]) -> None:
    decoder = codec.ReplyDecoder(3)
    replies = [decoder.feed(part) for part in parts(transcript.IDENTITY, cuts)]
    assert [reply for reply in replies if reply] == [("ND 287", "349797-01", "1.0")]


def test_values_and_indicators_are_read() -> None:
    position = codec.ReplyDecoder().feed(transcript.POSITION)
    assert position == ("-000123456",)
    assert codec.parse_position(position[0], 4) == pytest.approx(-12.3456)
    assert codec.displayed_decimals(transcript.DISPLAYED[1:-2].decode()) == 4
    assert codec.displayed_decimals("+ 12345") == 0
    assert codec.displayed_decimals("SIGNAL") is None
    bar = codec.parse_indicators(transcript.INDICATORS[1:-2].decode())
    assert (bar["REF"], bar["DATUM1"], bar["INCH"]) == (True, True, False)
    assert codec.ReplyDecoder().feed(transcript.ACKNOWLEDGED) == ("ACK",)
    assert codec.ReplyDecoder().feed(transcript.REFUSED) == ("NAK",)


@given(st.binary(max_size=200))
def test_random_bytes_are_a_reply_or_garbage(data: bytes) -> None:
    with contextlib.suppress(ProtocolError):
        reply = codec.ReplyDecoder().feed(data)
        if reply:
            assert math.isfinite(codec.parse_position(reply[0], 4))


@pytest.mark.parametrize("text", ["", "SIGNAL", "+1.5", "123", "+12345678901"])
def test_what_is_no_position_is_garbage(text: str) -> None:
    with pytest.raises(ProtocolError, match="no sign and digits"):
        codec.parse_position(text, 4)


def test_answers_have_the_lengths_of_the_manual(session: Session) -> None:
    assert len(talk(session, b"\x1bA0000\r")) == len(transcript.IDENTITY)
    assert b"EMULATOR" in talk(session, b"\x1bA0000\r")
    assert len(talk(session, b"\x1bA0200\r")) == len(transcript.POSITION)
    assert 13 <= len(talk(session, b"\x1bA0100\r")) <= 16
    assert talk(session, b"\x1bA0301\r") == b"\x02" + b" " * 13 + b"\r\n"
    assert len(talk(session, b"\x1bA0400\r")) == 13
    assert len(talk(session, b"\x1bA0900\r")) == len(transcript.INDICATORS)
    assert talk(session, b"\x02") == talk(session, b"\x1bF0200\r")


def test_a_datum_is_set_by_keys(session: Session) -> None:
    keys = b"".join(b"\x1b%s\r" % key for key in (b"T0101", b"T0001", b"T0102", b"T0005", b"T0104"))
    assert talk(session, keys) == transcript.ACKNOWLEDGED * 5
    assert talk(session, b"\x1bA0200\r") == b"\x02-000015000\r\n"
    assert talk(session, b"\x1bT0104\r") == transcript.REFUSED


def test_locked_keys_and_unknown_commands_are_refused(session: Session) -> None:
    assert talk(session, b"\x1bS0001\r\x1bT0000\r") == b"\x06\x15"
    assert talk(session, b"\x1bS0002\r\x1bT0000\r") == b"\x06\x06"
    assert talk(session, b"\x1bX9999\r") == transcript.REFUSED
    assert talk(session, b"hello\r") == transcript.REFUSED
    assert talk(session, b"\x1b" + b"A" * 300 + b"\r") == transcript.REFUSED


def test_an_error_stays_on_the_display_until_c_is_pressed(world: EmulationContext, session: Session) -> None:
    world.beam_bench.beam.block(0.5)
    assert b"SIGNAL" in talk(session, b"\x1bA0301\r")
    assert talk(session, b"\x1bT0100\r\x1bA0100\r") == b"\x06" + transcript.SHOWN_ERROR
    world.beam_bench.advance(1.0)
    assert b"SIGNAL" not in talk(session, b"\x1bT0100\r\x1bA0301\r")
    world.beam_bench.beam.block(0.5)
    world.beam_bench.advance(1.0)
    assert b"SIGNAL" in talk(session, b"\x1bA0301\r")


def test_no_error_text_is_blank_or_refused() -> None:
    refusing = new_session(quiet_world(), "heidenhain-nd", {"no_error": "refused"})
    assert talk(refusing, b"\x1bA0301\r") == transcript.REFUSED


def test_the_status_bar_differs_from_the_indicators(session: Session) -> None:
    assert talk(session, b"\x1bA0800\r") == transcript.STATUS_BAR


def test_older_displays_have_indicators_where_others_have_bars() -> None:
    older = new_session(quiet_world(), "heidenhain-nd", {"status_bar": False})
    assert talk(older, b"\x1bA0800\r") == talk(older, b"\x1bA0900\r")


STREAM = b"\x1bA0000\r\x02\x1bT0005\r\n\x1bT0104\r\x13\x11\x1bA0200\rjunk\r\x1bF0000\r"


@given(st.lists(st.integers(0, len(STREAM)), max_size=8))
def test_any_cut_of_commands_gives_the_same_answers(cuts: list[int]) -> None:
    session = new_session(quiet_world(), "heidenhain-nd")
    answers = b"".join(talk(session, part) for part in parts(STREAM, cuts))
    assert answers.endswith(b"\x02+000050000\r\n\x15\x06")


@given(st.lists(st.binary(max_size=200), max_size=5))
def test_random_bytes_do_the_emulator_no_harm(chunks: list[bytes]) -> None:
    session = new_session(quiet_world(), "heidenhain-nd")
    for chunk in chunks:
        talk(session, chunk)
    assert talk(session, b"\r\x1bS0000\r").endswith(transcript.ACKNOWLEDGED)


async def test_who_is_there() -> None:
    async with paired("heidenhain-nd", make, connect=False) as pair:
        identity = await pair.driver.connect()
        assert (identity.model, identity.firmware, identity.simulated) == ("ND 287", "EMULATOR 1.0", True)
        assert pair.driver.compensated == "none"


@pytest.mark.parametrize("zero", ["software", "keys"])
@pytest.mark.parametrize("decimals", [3, 5])
async def test_zero_by_offset_or_keys(zero: str, decimals: int) -> None:
    options: dict[str, str | int] = {"decimals": decimals, "compensated": "instrument", "sign": -1}
    async with paired(
        "heidenhain-nd", lambda t, c: make(t, c, zero=zero, decimals=decimals, sign=-1), options
    ) as pair:
        await pair.driver.zero()
        way_mm = driven_mm(pair.bench, aimed(20.01, 30.01))
        reading = await pair.driver.read()
        assert reading.displacement_mm == pytest.approx(way_mm, abs=1.1 * 10**-decimals)


async def test_no_zero_without_a_beam() -> None:
    async with paired("heidenhain-nd", make) as pair:
        pair.bench.beam.block(None)
        with pytest.raises(RefusedError, match="the display shows 'SIGNAL'"):
            await pair.driver.zero()


async def test_wrong_decimals_are_reported_with_the_right_ones() -> None:
    async with paired("heidenhain-nd", make, {"decimals": 3}, connect=False) as pair:
        with pytest.raises(WrongDeviceError, match="set decimals = 3"):
            await pair.driver.connect()


async def test_a_display_without_signal_can_be_connected() -> None:
    async with paired("heidenhain-nd", make, connect=False) as pair:
        pair.bench.beam.block(None)
        await pair.driver.connect()
        assert not (await pair.driver.status()).beam_ok


async def test_wrong_decimals_unseen_at_connecting_fail_the_zero() -> None:
    async with paired("heidenhain-nd", make, {"decimals": 3}, connect=False) as pair:
        pair.bench.beam.block(None)
        await pair.driver.connect()
        pair.bench.beam.unblock()
        with pytest.raises(WrongDeviceError, match="set decimals = 3"):
            await pair.driver.zero()


async def test_a_refused_error_text_means_no_error() -> None:
    async with paired("heidenhain-nd", make, {"no_error": "refused"}) as pair:
        assert (await pair.driver.status()).beam_ok
        pair.bench.beam.block(None)
        assert not (await pair.driver.status()).beam_ok
        pair.bench.beam.unblock()
        assert await pair.driver.zero() >= 1
        assert not (await pair.driver.status()).beam_lost


async def test_a_question_that_older_units_refuse_hides_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Display, "_error", lambda _display: transcript.REFUSED)
    async with paired("heidenhain-nd", make) as pair:
        assert (await pair.driver.status()).beam_ok
        pair.bench.beam.block(None)
        status = await pair.driver.status()
        assert (status.beam_ok, status.beam_lost, status.signal_native) == (False, True, "SIGNAL")


async def test_locked_keys_are_reported() -> None:
    async with paired("heidenhain-nd", lambda t, c: make(t, c, zero="keys")) as pair:
        talk(pair.far.new_session(), b"\x1bS0001\r")
        with pytest.raises(RefusedError, match=r"refused T0000.*keys are locked"):
            await pair.driver.zero()


async def test_a_stranger_is_named_by_its_bytes() -> None:
    async with Peer(lambda _data: [b"SSH-2.0-OpenSSH\r\n" * 3]) as peer:
        driver = make(peer.transport, StepClock())
        with pytest.raises(WrongDeviceError, match=r"not a Heidenhain ND|answers"):
            await driver.connect()
