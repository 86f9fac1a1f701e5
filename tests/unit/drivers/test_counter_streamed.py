"""Counters that send values by themselves, counters without status, and what a profile may say of them."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.counter import codec
from catseye.drivers.counter.counter import LineCounter
from catseye.drivers.counter.profile import CounterProfile, load_profile, parse_profile
from catseye.drivers.counter.streamed import StreamedCounter
from catseye.drivers.roles.errors import LinkTimeoutError, ProfileError, RefusedError, WrongDeviceError
from tests.unit.drivers.peers import Peer, StepClock, asked, settled

STREAM = """
format = "catseye-counter/1"
title = "streaming counter"
confirmed = true
compensated = "none"
[line]
timeout_s = 0.1
[query]
command = "unused"
reply = '^(?P<value>[-+]\\d+)$'
[zero]
mode = "software"
[scale]
unit = "nm"
decimals = 1
[stream]
mode = "commands"
start = "GO"
stop = "HALT"
"""


@asynccontextmanager
async def connected(text: str = STREAM) -> AsyncIterator[tuple[StreamedCounter, Peer]]:
    async with Peer(lambda _data: []) as peer:
        counter = StreamedCounter(peer.transport, StepClock(), parse_profile(text, "test"))
        await asked(counter.connect(), peer, b"OK\r\n+10\r\n")
        yield counter, peer
        await counter.close()


async def test_a_stream_is_started_read_and_stopped() -> None:
    async with connected() as (counter, peer):
        reading = await asked(counter.read(), peer, b"+12345\r\n")
        # One digit stands behind the decimal point that is not sent: 1234.5 nm.
        assert reading.displacement_mm == pytest.approx(1234.5e-6)
        assert await asked(counter.zero(), peer, b"+20000\r\n") == 1
        assert (await asked(counter.read(), peer, b"+20010\r\n")).displacement_mm == pytest.approx(1e-6)
        await counter.close()
        assert peer.requests == [b"GO\r\n", b"HALT\r\n"]


async def test_listeners_receive_values_since_zero_but_no_errors() -> None:
    async with connected() as (counter, peer):
        seen_mm: list[float] = []
        counter.listen(lambda _time_s, displacement_mm: seen_mm.append(displacement_mm))
        await asked(counter.zero(), peer, b"+20000\r\n")
        await asked(counter.status(), peer, b"E07\r\n")
        await asked(counter.read(), peer, b"+20010\r\n+20030\r\n")
        assert seen_mm == pytest.approx([2e-3, 1e-6, 3e-6])


async def test_a_streamed_error_loses_the_beam_until_zero() -> None:
    async with connected() as (counter, peer):
        status = await asked(counter.status(), peer, b"E07\r\n")
        assert (status.beam_ok, status.beam_lost, status.signal) == (False, True, 0.0)
        with pytest.raises(RefusedError, match="sends 'E07'"):
            await asked(counter.zero(), peer, b"E07\r\n")
        status = await asked(counter.status(), peer, b"+5\r\n")
        assert (status.beam_ok, status.beam_lost) == (True, True)
        await asked(counter.zero(), peer, b"+5\r\n")
        assert not (await asked(counter.status(), peer, b"+5\r\n")).beam_lost


async def test_a_stream_that_stops_is_an_error() -> None:
    async with connected() as (counter, _):
        with pytest.raises(LinkTimeoutError, match="no value within"):
            await counter.read()


async def test_a_stranger_is_reported() -> None:
    async with Peer(lambda _data: []) as peer:
        counter = StreamedCounter(peer.transport, StepClock(), parse_profile(STREAM, "test"))
        with pytest.raises(WrongDeviceError, match="does not fit the profile"):
            await asked(counter.connect(), peer, b"SSH-2.0\r\n")
        await counter.close()


LINES = b"+1\r\n\r\nE07\n\xff\xff\n+2\r+3\n"


@given(st.lists(st.integers(0, len(LINES)), max_size=6))
def test_any_cut_of_a_stream_gives_the_same_lines(cuts: list[int]) -> None:
    decoder = codec.StreamDecoder(parse_profile(STREAM, "test"))
    parts = [LINES[a:b] for a, b in pairwise([0, *sorted(cuts), len(LINES)])]
    lines = [line for part in parts for line in decoder.feed(part)]
    assert [line for line in lines if line.startswith("+")] == ["+1", "+2", "+3"]


@given(st.lists(st.binary(max_size=2000), max_size=5))
def test_random_bytes_do_no_harm(chunks: list[bytes]) -> None:
    decoder = codec.StreamDecoder(parse_profile(STREAM, "test"))
    for chunk in chunks:
        decoder.feed(chunk)
    assert decoder.feed(b"\n+7\n")[-1] == "+7"


def test_the_profile_decides_whether_to_ask_or_to_listen(tmp_path: Path) -> None:
    path = tmp_path / "stream.toml"
    path.write_text(STREAM, "utf-8")
    assert isinstance(LineCounter.at("tcp://127.0.0.1:1", StepClock(), profile=str(path)), StreamedCounter)
    assert isinstance(LineCounter.at("tcp://127.0.0.1:1", StepClock()), LineCounter)


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (('start = "GO"\n', ""), 'mode = "commands" needs start and stop'),
        (('mode = "commands"', 'mode = "unsolicited"'), "no other mode takes them"),
        (('mode = "software"', 'command = "Z"'), "nothing is asked during a stream"),
        (('unit = "nm"', 'unit = "count"\ncount_mm = 1e-6'), "put them into count_mm"),
    ],
)
def test_streams_that_cannot_be_are_refused(change: tuple[str, str], fault: str) -> None:
    with pytest.raises(ProfileError, match=fault):
        parse_profile(STREAM.replace(*change), "test")


async def test_without_a_status_query_error_values_lose_the_beam() -> None:
    tables = load_profile("default").model_dump(exclude={"status", "signal"}, exclude_none=True)
    tables["start"] = {"init": ["ON", "FAST"], "shutdown": ["OFF"]}
    shown = "+1.0 mm"

    def answer(data: bytes) -> list[bytes]:
        said = {b"I\r\n": "EMULATOR", b"R\r\n": shown, b"ON\r\n": "ready"}.get(data)
        return [f"{said}\r\n".encode()] if said else []

    async with Peer(answer) as peer:
        counter = LineCounter(
            peer.transport, StepClock(), CounterProfile.model_validate(tables), quiet_s=0.001
        )
        await counter.connect()
        status = await counter.status()
        assert (status.beam_ok, status.beam_lost, status.signal) == (True, False, 1.0)
        shown = "E02"
        status = await counter.status()
        assert (status.beam_ok, status.beam_lost, status.signal) == (False, True, 0.0)
        await counter.close()
        await settled()
        assert peer.requests[:4] == [b"ON\r\n", b"FAST\r\n", b"I\r\n", b"R\r\n"]
        assert peer.requests[-1] == b"OFF\r\n"


def test_silence_is_an_answer_to_a_command_at_the_start() -> None:
    decoder = codec.QuietDecoder()
    decoder.feed(b"ready\r\n")
    assert decoder.end()
