"""uMD displays: the published layout, both codecs, the stream, software zero."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.testing.memory import MemoryTransport
from catseye.drivers.roles.errors import LinkTimeoutError, RefusedError, WrongDeviceError
from catseye.drivers.umd import codec
from catseye.drivers.umd.display import UmdDisplay, UmdSettings
from catseye.simulators.umd import display as umd_session
from catseye.simulators.umd.display import Umd, UmdOptions, UmdSession
from catseye.simulators.world.air_probe import AirProbe
from catseye.simulators.world.instrument import Instrument
from catseye.simulators.world.timekeeper import TimeKeeper
from tests.transcripts import umd as transcript
from tests.unit.drivers.interferometers.pairs import new_session, paired, quiet_world
from tests.unit.drivers.peers import Peer, StepClock, asked, settled
from tests.unit.simulators.benches import aimed, driven_mm, quiet_bench

HALF_WAVE_MM = 632.9908e-6 / 2.0


def make(transport: MemoryTransport, clock: StepClock, **settings: Any) -> UmdDisplay:
    return UmdDisplay(transport, clock, UmdSettings(timeout_s=0.5, **settings))


def parts(data: bytes, cuts: list[int]) -> list[bytes]:
    return [data[a:b] for a, b in pairwise([0, *sorted(cuts), len(data)])]


def line(sequence: int, displacement: int = 0, measured: int = 1500) -> bytes:
    return f"1500 {measured} {displacement} 0 0 {sequence} 0 0\r\n".encode()


def test_the_published_layouts_are_read() -> None:
    one, three, lost = codec.SampleDecoder().feed(
        transcript.ONE_AXIS + transcript.THREE_AXES + transcript.BEAM_LOST
    )
    assert (one.reference, one.sequence, one.low_code, one.low_data) == (1500, 4711, 10, 100)
    assert one.axes == (codec.Axis(1503, -31605, 3, 64),)
    assert one.axes[0].counts == -31604.75
    assert three.axes[1:] == (codec.Axis(1500, 12, 0, 128), codec.Axis(0, 7, 0, 0))
    assert lost.axes[0].measured == 0


STREAM = b"12 34\r\n" + transcript.ONE_AXIS + b"\n" + transcript.THREE_AXES + b"a b c d e f g h\n" + line(5)


@given(st.lists(st.integers(0, len(STREAM)), max_size=8))
def test_any_cut_of_a_stream_gives_the_same_samples(cuts: list[int]) -> None:
    decoder = codec.SampleDecoder()
    samples = [sample for part in parts(STREAM, cuts) for sample in decoder.feed(part)]
    assert [sample.sequence for sample in samples] == [4711, 4712, 5]
    assert decoder.discarded_lines == 2


@given(st.lists(st.binary(max_size=300), max_size=5))
def test_random_bytes_do_no_harm(chunks: list[bytes]) -> None:
    decoder = codec.SampleDecoder()
    session = new_session(quiet_world(), "umd")
    for chunk in chunks:
        decoder.feed(chunk)
        session.feed(chunk)
        assert session.answer() is None
    assert decoder.feed(b"\n" + transcript.ONE_AXIS)[-1].sequence == 4711


@pytest.mark.parametrize("field", [b"9" * 400, b"1_000", b"12a", b"1.5"])
def test_what_is_no_number_of_the_display_is_left_out(field: bytes) -> None:
    decoder = codec.SampleDecoder()
    assert decoder.feed(b"1500 1500 " + field + b" 0 0 5 0 0\r\n") == []
    assert decoder.discarded_lines == 1


def test_an_endless_line_is_not_kept() -> None:
    decoder = codec.SampleDecoder()
    for _ in range(100):
        assert decoder.feed(b"1" * 400) == []
    assert decoder.feed(b"\n" + transcript.ONE_AXIS)[0].sequence == 4711


@pytest.mark.parametrize(
    ("last", "now", "lost"),
    [(4, 5, 0), (4, 8, 3), (65535, 0, 0), (2**32 - 1, 0, 0), (700, 0, None), (700, 3, None)],
)
def test_gaps_wraps_and_restarts(last: int, now: int, lost: int | None) -> None:
    assert codec.missing(last, now) == lost


@pytest.mark.parametrize(("rate_hz", "axes"), [(610.35, 1), (1000, 3)])
def test_the_emulator_streams_every_sample_at_its_time(rate_hz: float, axes: int) -> None:
    world = quiet_world()
    session = new_session(world, "umd", {"rate_hz": rate_hz, "axes": axes})
    start_s = world.bench.time_s
    samples: list[codec.Sample] = []
    decoder = codec.SampleDecoder()
    # However coarsely time passes, each sample is there.
    for step_s in (0.0001, 0.5, 0.003, 0.4, 0.0969):
        world.bench.advance(step_s)
        samples += decoder.feed(session.output())
    assert abs(len(samples) - rate_hz * (world.bench.time_s - start_s)) <= 1.0
    assert {b.sequence - a.sequence for a, b in pairwise(samples)} == {1}
    assert {len(sample.axes) for sample in samples} == {axes}
    low = {sample.low_code: sample.low_data for sample in samples}
    assert low[8] == round(100 * rate_hz)
    assert low[0] == codec.EMULATOR_MARK
    assert {3, 5, 6, 10} <= low.keys()
    session.close()


def test_the_stream_keeps_its_real_time_rate() -> None:
    world = quiet_world()
    world.keeper.speed = 50.0
    session = new_session(world, "umd", {"rate_hz": 1000})
    world.bench.advance(50.0)
    assert len(codec.SampleDecoder().feed(session.output())) == pytest.approx(1000, abs=1)


def test_a_new_client_receives_no_earlier_samples() -> None:
    now_s = 0.0
    bench = quiet_bench()
    keeper = TimeKeeper(bench, clock=lambda: now_s)
    umd = Umd(Instrument(bench), AirProbe(bench), keeper, UmdOptions(rate_hz=1000))
    now_s = 30.0
    session = UmdSession(umd)
    now_s = 30.5
    keeper.sync()
    samples = codec.SampleDecoder().feed(session.output())
    assert len(samples) == pytest.approx(500, abs=1)
    assert samples[0].sequence == pytest.approx(30_000, abs=1)


def test_what_nobody_takes_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(umd_session, "MOST_LINES", 500)
    world = quiet_world()
    session = new_session(world, "umd", {"rate_hz": 1000})
    world.bench.advance(0.7)
    numbers = [int(said.split()[5]) for said in session.output().splitlines()]
    world.bench.advance(0.0015)
    following = int(session.output().split()[5])
    assert numbers == list(range(following - 500, following))


async def test_who_is_there() -> None:
    async with paired("umd", make, connect=False) as pair:
        identity = await pair.driver.connect()
        assert (identity.model, identity.firmware, identity.simulated) == ("uMD display", "100", True)
        assert pair.driver.compensated == "none"


@pytest.mark.parametrize("multiplier", [1, 4])
async def test_counts_become_lengths_in_vacuum_wavelengths(multiplier: int) -> None:
    async with paired(
        "umd", lambda t, c: make(t, c, multiplier=multiplier, sign=-1), {"multiplier": multiplier, "sign": -1}
    ) as pair:
        assert await pair.driver.zero() == 1
        way_mm = driven_mm(pair.bench, aimed(20.01, 30.01))
        reading = await pair.driver.read()
        assert reading.displacement_mm == pytest.approx(way_mm * 1.000271, abs=2e-5)
        assert reading.raw.endswith("counts")


@asynccontextmanager
async def connected(**settings: Any) -> AsyncIterator[tuple[UmdDisplay, Peer]]:
    """Connect a driver to a peer that has said samples 0 to 39."""
    async with Peer(lambda _data: []) as peer:
        driver = make(peer.transport, StepClock(), **settings)
        connecting = asyncio.create_task(driver.connect())
        await settled()
        await peer.say(lines(0, 40))
        await connecting
        yield driver, peer
        await driver.close()


def lines(first: int, count: int, **fields: int) -> bytes:
    return b"".join(line(first + k, **fields) for k in range(count))


async def test_missing_samples_are_counted_and_latched_until_zero() -> None:
    async with connected() as (driver, peer):
        status = await asked(driver.status(), peer, line(47))
        assert (status.values_lost, status.beam_lost, driver.lost_samples) == (True, False, 7)
        await asked(driver.zero(), peer, line(48))
        assert not (await asked(driver.status(), peer, line(49))).values_lost


async def test_a_display_that_starts_anew_has_lost_its_count() -> None:
    async with connected() as (driver, peer):
        await asked(driver.zero(), peer, line(40))
        status = await asked(driver.status(), peer, line(0))
        assert (status.beam_ok, status.beam_lost, status.values_lost) == (True, True, False)


async def test_a_beam_that_breaks_between_two_questions_is_latched() -> None:
    async with connected() as (driver, peer):
        await asked(driver.zero(), peer, line(40))
        await peer.say(line(41, measured=0) + line(42))
        status = await asked(driver.status(), peer, line(43))
        assert (status.beam_ok, status.beam_lost) == (True, True)
        with pytest.raises(RefusedError, match="no beam returns"):
            await asked(driver.zero(), peer, line(44, measured=0))


async def test_zero_is_an_offset_in_the_program() -> None:
    async with connected() as (driver, peer):
        await asked(driver.zero(), peer, line(40, displacement=1000))
        reading = await asked(driver.read(), peer, line(41, displacement=4000))
        assert reading.displacement_mm == pytest.approx(3000 * HALF_WAVE_MM)
        assert peer.requests == []


async def test_every_sample_of_the_stream_is_yielded_once() -> None:
    async with connected() as (driver, peer):
        numbers: list[int] = []

        async def collect() -> None:
            async for timed in driver.samples():
                numbers.append(timed.sample.sequence)
                if len(numbers) == 100:
                    return

        task = asyncio.create_task(collect())
        await settled()
        for first in range(40, 140, 10):
            await peer.say(lines(first, 10))
            await settled()
        await task
        assert numbers == list(range(40, 140))
        assert driver.lost_samples == 0


async def test_a_slow_caller_loses_the_oldest_samples_countably() -> None:
    async with connected(ring_samples=16) as (driver, peer):
        samples = driver.samples()
        first = asyncio.ensure_future(anext(samples))
        await settled()
        await peer.say(line(40))
        assert (await first).sample.sequence == 40
        await peer.say(lines(41, 50))
        await settled()
        assert (await anext(samples)).sample.sequence == 75
        assert driver.lost_samples == 34


async def test_a_stream_that_stops_is_an_error() -> None:
    async with connected() as (driver, _):
        with pytest.raises(LinkTimeoutError, match="no sample within"):
            await driver.read()


async def test_a_display_without_the_axis_is_reported() -> None:
    with pytest.raises(WrongDeviceError, match="with axis 2"):
        async with connected(axis=2):
            pass


async def test_a_stranger_is_named_by_its_bytes() -> None:
    async with Peer(lambda _data: []) as peer:
        driver = make(peer.transport, StepClock())
        with pytest.raises(WrongDeviceError, match=r"not samples of a uMD.*SSH"):
            await asked(driver.connect(), peer, b"SSH-2.0-OpenSSH\r\n")
