"""Conversations of the past, played again."""

import asyncio
import os
from pathlib import Path

import pytest

from catseye.app.testing.replay import DeviationError, ReplayTransport, Step, load_transcript
from catseye.drivers.counter.counter import LineCounter
from catseye.drivers.counter.profile import load_profile
from catseye.drivers.links.record import RecordingTransport
from catseye.drivers.roles.device import Entry
from catseye.drivers.roles.errors import LinkError
from tests.unit.drivers.peers import Peer, StepClock
from tests.unit.drivers.test_counter import Counter
from tests.unit.drivers.virtual_time import run

STEPS: list[Step] = [
    ("tx", b"1;1;STATE\r"),
    ("rx", b"Qo"),
    ("rx", b"K1\r"),
    ("tx", b"1;1;STOP\r"),
    ("rx", b"QoK\r"),
]


async def test_what_came_comes_again_in_its_chunks() -> None:
    link = ReplayTransport(STEPS)
    await link.open()
    assert link.waiting() == b""
    # How the bytes are cut does not matter.
    await link.write(b"1;1;ST")
    assert link.waiting() == b""
    await link.write(b"ATE\r")
    assert [await link.read(), link.waiting(), link.waiting()] == [b"Qo", b"K1\r", b""]
    await link.write(b"1;1;STOP\r")
    assert await link.read() == b"QoK\r"
    assert link.finished
    with pytest.raises(LinkError, match="the transcript has ended"):
        await link.read()
    await link.close()
    await link.close()


async def test_reading_waits_for_what_has_to_be_sent_first() -> None:
    link = ReplayTransport(STEPS)
    await link.open()
    reading = asyncio.create_task(link.read())
    await asyncio.sleep(0)
    assert not reading.done()
    await link.write(b"1;1;STATE\r")
    assert await reading == b"Qo"
    await link.close()


async def test_a_deviation_shows_both_sides_aligned() -> None:
    link = ReplayTransport(STEPS)
    await link.open()
    with pytest.raises(DeviationError) as caught:
        await link.write(b"1;1;STOP\r")
    lines = str(caught.value).splitlines()
    assert lines[0] == "replay://transcript: byte 6 differs from the transcript:"
    assert lines[1].startswith("  sent      31 3b 31 3b 53 54 4f 50 0d ")
    assert lines[2].startswith("  expected  31 3b 31 3b 53 54 41 54 45 0d ")
    assert lines[3].index("^^") == lines[1].index("4f") == lines[2].index("41")


@pytest.mark.parametrize("extra", [b"1;1;STATE\rX", b"1;1;STATE\r1;1;STOP\rX"])
async def test_too_much_is_a_deviation_too(extra: bytes) -> None:
    link = ReplayTransport(STEPS)
    await link.open()
    with pytest.raises(DeviationError, match=f"byte {len(extra) - 1} differs"):
        await link.write(extra)


async def test_a_closed_replay_refuses() -> None:
    link = ReplayTransport(STEPS)
    with pytest.raises(LinkError, match="open it first"):
        await link.write(b"1")
    with pytest.raises(LinkError, match="open it first"):
        await link.read()


def test_a_recorded_conversation_satisfies_the_same_driver_again() -> None:
    steps: list[Step] = []

    def keep(entry: Entry, data: bytes) -> None:
        assert entry != "heal"
        steps.append((entry, data))

    async def converse(counter: LineCounter) -> tuple[object, ...]:
        try:
            return await counter.connect(), await counter.read(), await counter.status()
        finally:
            await counter.close()

    async def work() -> None:
        async with Peer(Counter().answer) as peer:
            recorded = RecordingTransport(peer.transport, keep)
            first = await converse(LineCounter(recorded, StepClock(), load_profile("default")))
        replay = ReplayTransport(steps)
        assert await converse(LineCounter(replay, StepClock(), load_profile("default"))) == first
        assert replay.finished

    run(work())


def test_the_wire_log_of_a_run_is_a_transcript(tmp_path: Path) -> None:
    log = tmp_path / "wire.log"
    log.write_text(
        '{"t": "2026-01-02T00:00:00+00:00", "device": "robot", "direction": "tx", "hex": "313b", "text": "1;"}\n'
        '{"t": "2026-01-02T00:00:00+00:00", "device": "environment", "direction": "rx", "hex": "00", "text": "."}\n'
        '{"t": "2026-01-02T00:00:00+00:00", "device": "robot", "direction": "heal", "hex": "78", "text": "x"}\n'
        '{"t": "2026-01-02T00:00:00+00:00", "device": "robot", "direction": "rx", "hex": "516f4b", "text": "QoK"}\n'
    )
    assert load_transcript(log, "robot") == [("tx", b"1;"), ("rx", b"QoK")]
    assert len(load_transcript(log)) == 3


@pytest.mark.parametrize(
    "line",
    ["no json", "[]", '{"hex": "00"}', '{"direction": "up", "hex": "00"}', '{"direction": "tx", "hex": "0"}'],
)
def test_a_line_that_is_none_is_named(tmp_path: Path, line: str) -> None:
    log = tmp_path / "wire.log"
    log.write_text(f'{{"direction": "tx", "hex": "00"}}\n{line}\n')
    with pytest.raises(ValueError, match=r"wire\.log:2: "):
        load_transcript(log)


def test_a_transcript_that_is_no_file_is_refused(tmp_path: Path) -> None:
    # Opened, a pipe that nobody writes would be waited for.
    os.mkfifo(tmp_path / "wire.log")
    with pytest.raises(OSError, match="is a pipe, not a regular file"):
        load_transcript(tmp_path / "wire.log")


def test_a_line_nested_too_deeply_is_named(tmp_path: Path) -> None:
    (tmp_path / "wire.log").write_text("[" * 100_000)
    with pytest.raises(ValueError, match=r"wire\.log:1: "):
        load_transcript(tmp_path / "wire.log")


def test_a_transcript_that_is_no_text_is_named(tmp_path: Path) -> None:
    path = tmp_path / "wire.log"
    path.write_bytes(b'{"direction": "tx", "hex": "\x8c"}')
    with pytest.raises(ValueError, match=r"wire\.log:1: not a line of a transcript"):
        load_transcript(path)
