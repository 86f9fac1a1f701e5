"""Lasertex HPI-3D: bytes of the open client, both codecs, the driver on the emulator."""

import asyncio
import struct
from collections.abc import Coroutine
from itertools import pairwise
from typing import Any, TypeVar

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.testing.memory import MemoryTransport
from catseye.drivers.lasertex import codec
from catseye.drivers.lasertex.hpi import HpiSettings, LasertexHpi
from catseye.drivers.roles.errors import LinkTimeoutError, ProtocolError, RefusedError, WrongDeviceError
from catseye.simulators.context import EmulationContext
from catseye.simulators.lasertex import frames
from catseye.simulators.ports.session import Session
from catseye.simulators.world.air_probe import AirFault
from tests.transcripts import lasertex_hpi as transcript
from tests.unit.drivers.interferometers.pairs import new_session, paired, quiet_world
from tests.unit.drivers.peers import Peer, StepClock
from tests.unit.simulators.benches import aimed, go

T = TypeVar("T")

EXAMPLE = bytes.fromhex(transcript.DISTANCE)


def make(transport: MemoryTransport, clock: StepClock) -> LasertexHpi:
    return LasertexHpi(transport, clock, HpiSettings(timeout_s=0.5))


def parts(data: bytes, cuts: list[int]) -> list[bytes]:
    return [data[a:b] for a, b in pairwise([0, *sorted(cuts), len(data)])]


def said(session: Session, data: bytes) -> list[codec.Frame]:
    session.feed(data)
    answer = b""
    while (piece := session.answer()) is not None:
        assert isinstance(piece, bytes)
        answer += piece
    return codec.FrameDecoder().feed(answer)


@pytest.mark.parametrize(("code", "frame"), transcript.COMMANDS.items())
def test_command_frames_are_those_of_the_client(code: int, frame: str) -> None:
    assert codec.command(code) == bytes.fromhex(frame)
    assert frames.CommandCutter().feed(bytes.fromhex(frame)) == [code]


@pytest.mark.parametrize("cuts", [[], [3], [1, 2, 8, 15]])
def test_the_published_distance_is_read(cuts: list[int]) -> None:
    decoder = codec.FrameDecoder()
    (frame,) = [frame for part in parts(EXAMPLE, cuts) for frame in decoder.feed(part)]
    distance = codec.parse_distance(frame)
    assert distance.length_mm == pytest.approx(1.234567, abs=1e-12)
    assert (distance.level, distance.laser_ready, distance.signal_ok, distance.overspeed) == (
        80,
        True,
        True,
        False,
    )


def test_the_emulator_sends_the_published_distance() -> None:
    said = frames.distance(1.234567, overspeed=False, laser_ready=True, signal_ok=True, level=80)
    assert said == EXAMPLE


def test_meteo_and_velocity_lie_where_the_client_reads_them() -> None:
    meteo = frames.meteo(0, -3.21, 45.4, 1013.2)
    assert meteo[:3] == bytes.fromhex("AA B0 0A")
    assert struct.unpack(">BhBBBh", meteo[3:11]) == (0, -321, 45, 100, 100, 10132)
    velocity = frames.velocity(-12.5, overspeed=True, laser_ready=True, signal_ok=False, level=0)
    assert struct.unpack(">i", velocity[3:7]) == (-125_000,)
    assert velocity[12:15] == bytes((0x08, 0x01, 0))


def test_a_damaged_frame_is_skipped() -> None:
    decoder = codec.FrameDecoder()
    damaged = EXAMPLE[:9] + b"\xaa" + EXAMPLE[10:]
    assert len(decoder.feed(b"\x00\xaa\x11" + damaged + EXAMPLE + EXAMPLE)) == 2
    assert decoder.discarded_bytes == 3 + 16


def test_another_frame_is_no_distance() -> None:
    with pytest.raises(ProtocolError, match="B00A is not a distance"):
        codec.parse_distance(codec.Frame(0xB00A, bytes(12)))


@given(st.lists(st.integers(0, 3 * 16 + 5), max_size=6), st.binary(max_size=5))
def test_any_cut_of_a_stream_gives_the_same_frames(cuts: list[int], noise: bytes) -> None:
    stream = noise + EXAMPLE * 3
    whole = codec.FrameDecoder().feed(stream)
    decoder = codec.FrameDecoder()
    assert [frame for part in parts(stream, cuts) for frame in decoder.feed(part)] == whole
    assert len(whole) >= 2


COMMAND_STREAM = b"".join(bytes.fromhex(frame) for frame in transcript.COMMANDS.values())


@given(st.lists(st.integers(0, len(COMMAND_STREAM)), max_size=6))
def test_any_cut_of_commands_gives_the_same_codes(cuts: list[int]) -> None:
    cutter = frames.CommandCutter()
    codes = [code for part in parts(COMMAND_STREAM, cuts) for code in cutter.feed(part)]
    assert codes == list(transcript.COMMANDS)


@given(st.lists(st.binary(max_size=200), max_size=5))
def test_random_bytes_do_no_harm(chunks: list[bytes]) -> None:
    decoder, cutter = codec.FrameDecoder(), frames.CommandCutter()
    for chunk in chunks:
        decoder.feed(chunk)
        cutter.feed(chunk)
    assert codec.DISTANCE in {frame.code for frame in decoder.feed(bytes(16) + EXAMPLE)}
    assert 0xB048 in cutter.feed(bytes(8) + codec.command(0xB048))


@pytest.fixture
def world() -> EmulationContext:
    return quiet_world()


def test_each_command_is_acknowledged_by_its_code(world: EmulationContext) -> None:
    session = new_session(world, "lasertex-hpi")
    answers = said(session, COMMAND_STREAM)
    assert [frame.code for frame in answers] == list(transcript.COMMANDS)
    assert answers[0].data.startswith(b"EMULATOR")


def test_what_is_no_command_gets_no_answer(world: EmulationContext) -> None:
    session = new_session(world, "lasertex-hpi")
    assert said(session, bytes.fromhex("AA B0 32 00 00 00 00 8F") + codec.command(0xB099)) == []


def test_streams_run_at_their_rates_and_distance_excludes_velocity(world: EmulationContext) -> None:
    session = new_session(world, "lasertex-hpi")
    for code in (0xB034, 0xB032, 0xB079):
        said(session, codec.command(code))
    codes: list[int] = []
    start_s = world.bench.time_s
    while (due_s := session.next_output_s()) is not None and due_s < start_s + 1.01:
        world.bench.advance_to(due_s)
        output = session.output()
        assert len(output) % 16 == 0
        codes += [frame.code for frame in codec.FrameDecoder().feed(output)]
    assert (codes.count(0xB015), codes.count(0xB016), codes.count(0xB00A)) == (25, 0, 2)
    said(session, codec.command(0xB03C))
    assert session.next_output_s() is None


def test_a_sensor_that_measures_nothing_sends_nothing(world: EmulationContext) -> None:
    world.air.fault = AirFault(missing=True)
    session = new_session(world, "lasertex-hpi")
    said(session, codec.command(0xB079))
    world.bench.advance(1.0)
    assert session.output() == b""


async def test_the_driver_counts_in_vacuum_wavelengths() -> None:
    async with paired("lasertex-hpi", make, connect=False) as pair:
        identity = await pair.driver.connect()
        assert (identity.model, identity.simulated) == ("Lasertex HPI-3D", True)
        assert await pair.driver.zero() == 1
        before = pair.bench.true_state().length_mm
        go(pair.bench, aimed(20.01, 30.01))
        reading = await pair.driver.read()
        way_mm = pair.bench.true_state().length_mm - before
        assert reading.displacement_mm == pytest.approx(way_mm * 1.00027, rel=1e-4, abs=2e-6)
        assert reading.displacement_mm != pytest.approx(way_mm, abs=1e-6)
        assert reading.zero_id == 1


async def test_an_instrument_that_compensates_shows_the_length_itself() -> None:
    async with paired("lasertex-hpi", make, {"compensated": "instrument", "sign": -1}) as pair:
        await pair.driver.zero()
        before = pair.bench.true_state().length_mm
        go(pair.bench, aimed(20.01, 30.01))
        way_mm = pair.bench.true_state().length_mm - before
        assert (await pair.driver.read()).displacement_mm == pytest.approx(-way_mm, abs=1e-6)


async def test_no_zero_without_a_beam() -> None:
    async with paired("lasertex-hpi", make) as pair:
        pair.bench.beam.block(None)
        with pytest.raises(RefusedError, match="signal is too small"):
            await pair.driver.zero()


async def streamed(question: Coroutine[Any, Any, T], peer: Peer) -> T:
    """Ask the driver while distances go on coming."""
    task = asyncio.create_task(question)
    while not task.done():
        await asyncio.sleep(0)
        if peer.transport.is_open:
            await peer.say(EXAMPLE)
    return await task


async def test_a_zero_that_is_given_up_spoils_the_old_count() -> None:
    zero_sent = asyncio.Event()

    def answer(data: bytes) -> list[bytes]:
        code = int.from_bytes(data[1:3], "big")
        if code != codec.ZERO:
            return [frames.frame(code, b"")]
        zero_sent.set()
        return []

    async with Peer(answer) as peer:
        driver = make(peer.transport, StepClock())
        await streamed(driver.connect(), peer)
        assert not (await streamed(driver.status(), peer)).beam_lost
        zeroing = asyncio.create_task(driver.zero())
        await zero_sent.wait()
        zeroing.cancel()
        with pytest.raises(asyncio.CancelledError):
            await zeroing
        assert (await streamed(driver.status(), peer)).beam_lost
        await driver.close()


async def test_a_stopped_stream_is_an_error_and_reconnects() -> None:
    def impatient(transport: MemoryTransport, clock: StepClock) -> LasertexHpi:
        return LasertexHpi(transport, clock, HpiSettings(timeout_s=0.05))

    async with paired("lasertex-hpi", impatient) as pair:
        await pair.driver.zero()
        pair.far.muted = True
        with pytest.raises(LinkTimeoutError, match=r"no distance within 0\.05 s"):
            await pair.driver.read()
        pair.far.muted = False
        await pair.driver.read()
        assert (await pair.driver.status()).beam_lost


async def test_a_stranger_is_named_by_its_bytes() -> None:
    async with Peer(lambda _data: [b"SSH-2.0-OpenSSH\r\n"]) as peer:
        driver = LasertexHpi(peer.transport, StepClock(), HpiSettings(timeout_s=0.05))
        with pytest.raises(WrongDeviceError, match=r"not a Lasertex HPI-3D.*SSH"):
            await driver.connect()
        assert not peer.transport.is_open
