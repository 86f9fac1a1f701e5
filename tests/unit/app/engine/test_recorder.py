"""Recording a length counter: steady questions, streams, and what becomes of a counter that falls behind."""

import asyncio
import re
from collections.abc import AsyncIterator
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from catseye.app.engine import recorder as module
from catseye.app.engine.recorder import Recorder, recorder_at_work
from catseye.app.errors import StorageError
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.app.store.verify import verify
from catseye.drivers.roles.errors import LinkError, RefusedError
from catseye.drivers.roles.interferometer import LengthReading, StreamedInterferometer
from catseye.procedures.kit.recording import Recorded
from catseye.procedures.kit.records import Row, row_of
from tests.unit.app.engine.fakes import FakeCounter, ManualClock
from tests.unit.app.engine.given_parts import Parts

KEY = ("A1", 1, "series")


@dataclass
class SlowCounter(FakeCounter):
    """Some of its answers take longer, or are refused."""

    delays_s: tuple[float, ...] = ()
    errors: tuple[Exception | None, ...] = ()

    async def read(self) -> LengthReading:
        if self.count < len(self.delays_s):
            self.clock.advance(self.delays_s[self.count])
        reading = await super().read()
        error = self.errors[self.count - 1] if self.count <= len(self.errors) else None
        if error is not None:
            raise error
        return reading


@dataclass
class StreamedCounter(FakeCounter, StreamedInterferometer):
    """Sends what a test has it send."""

    @property
    def streams(self) -> bool:
        return True

    def send(self, *times_s: float) -> None:
        """Send a reading at each of some times, in nanometres what its time is in seconds."""
        for time_s in times_s:
            if self._on_value is not None:
                self._on_value(time_s, time_s * 1e-6)


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
async def store(tmp_path: Path, clock: ManualClock) -> AsyncIterator[RunStore]:
    made = await RunStore.create(tmp_path, "resolution", {}, clock, records=(Recorded,), reserve_bytes=0)
    yield made
    await made.abandon()


async def record(store: RunStore, counter: FakeCounter, duration_s: float) -> Row:
    """Record for a time, in a step that is done then; return what was stored of it."""
    recorder = Recorder(counter, store, counter.clock, KEY, 25.0)
    async with recorder_at_work(recorder):
        await counter.clock.sleep(duration_s)
    row = row_of(recorder.recorded(await counter.status(), 1.0, 0.0))
    await store.append_step(KEY[0], KEY[1], "A1", {}, [(Recorded.table, row)])
    return row


def readings(store: RunStore) -> list[tuple[float, float]]:
    reader = RunReader(store.path)
    (row,) = reader.recordings()
    return [pair for part in reader.chunks(row) for pair in zip(part.times_s, part.values, strict=True)]


def stored_readings(store: RunStore) -> int:
    """Return how many readings of an unfinished step are on the disk."""
    found = re.match(r"(\d+) readings of recording series", verify(store.path).notes[-1])
    return int(found[1]) if found else 0


async def test_a_counter_is_asked_at_a_steady_rate(store: RunStore, clock: ManualClock) -> None:
    row = await record(store, FakeCounter(clock), 60.0)
    # Fifteen hundred questions in a minute, the first one at once; the minute may end before or after the last.
    assert row["readings"] in {1500, 1501, 1502}
    assert row["rate_hz"] == pytest.approx(25.0)
    assert row["asked_hz"] == pytest.approx(25.0)
    assert row["jitter_s"] == pytest.approx(0.0, abs=1e-6)
    assert (row["method"], row["late"], row["lost"]) == ("polled", 0, 0)
    kept = readings(store)
    assert [time_s for time_s, _ in kept[:4]] == pytest.approx([0.0, 0.04, 0.08, 0.12])
    # The counter counts a micrometre a reading: nothing is missing, doubled or out of order.
    assert [value for _, value in kept] == pytest.approx([1e-3 * n for n in range(1, len(kept) + 1)])


async def test_readings_are_stored_while_more_come(store: RunStore, clock: ManualClock) -> None:
    recorder = Recorder(FakeCounter(clock), store, clock, KEY, 25.0)
    async with recorder_at_work(recorder):
        await clock.sleep(25.0)
        # Twice ten seconds, or more where the disk was slow and readings came while it wrote.
        async with asyncio.timeout(30.0):
            while stored_readings(store) < 500:  # noqa: ASYNC110  # the disk tells nobody
                await asyncio.sleep(0)
        assert recorder.readings > 600


@pytest.mark.parametrize("reason", [asyncio.CancelledError(), LinkError("the robot is gone")])
async def test_a_recording_that_breaks_off_keeps_all_readings(
    store: RunStore, clock: ManualClock, reason: BaseException
) -> None:
    recorder = Recorder(FakeCounter(clock), store, clock, KEY, 25.0)

    async def broken_off() -> None:
        async with recorder_at_work(recorder):
            await clock.sleep(3.0)
            raise reason

    with pytest.raises(type(reason)):
        await broken_off()
    # Three seconds are far from filling a chunk.
    assert stored_readings(store) == recorder.readings >= 75


async def test_a_chunk_being_stored_outlives_a_cancellation(store: RunStore, clock: ManualClock) -> None:
    counter = StreamedCounter(clock)
    recorder = Recorder(counter, store, clock, KEY, 25.0)

    async def cancelled() -> None:
        async with recorder_at_work(recorder):
            await asyncio.sleep(0)
            counter.send(0.0, 5.0, 10.0)
            # The store has the first chunk by now, and has not answered.
            await asyncio.sleep(0)
            counter.send(10.1)
            raise asyncio.CancelledError

    with pytest.raises(asyncio.CancelledError):
        await cancelled()
    assert stored_readings(store) == 4


async def test_a_late_reading_keeps_its_true_time(store: RunStore, clock: ManualClock) -> None:
    row = await record(store, SlowCounter(clock, delays_s=(0.0, 0.03, 0.09)), 1.0)
    # One is due after 40 ms and 30 ms late, the next after 80 ms and 90 ms late: two questions are left out.
    assert [time_s for time_s, _ in readings(store)][:5] == pytest.approx([0.0, 0.07, 0.17, 0.2, 0.24])
    assert (row["late"], row["lost"]) == (2, 2)
    assert row["longest_gap_s"] == pytest.approx(0.1)


async def test_a_refused_reading_leaves_a_gap(store: RunStore, clock: ManualClock) -> None:
    dark = RefusedError("no beam", 3)
    row = await record(store, SlowCounter(clock, errors=(None, dark, dark)), 1.0)
    assert [time_s for time_s, _ in readings(store)][:3] == pytest.approx([0.0, 0.12, 0.16])
    assert row["lost"] == 2


async def test_a_lost_link_ends_the_recording(store: RunStore, clock: ManualClock) -> None:
    counter = SlowCounter(clock, errors=(None, LinkError("the cable")))
    recorder = Recorder(counter, store, clock, KEY, 25.0)

    async def record_on() -> None:
        async with recorder_at_work(recorder):
            await clock.sleep(5.0)

    task = asyncio.create_task(record_on())
    while recorder.failure is None:  # noqa: ASYNC110  # the recorder only keeps it
        await asyncio.sleep(0)
    with pytest.raises(LinkError, match="the cable"):
        recorder.require_going_on()
    clock.advance(5.0)
    with pytest.raises(LinkError, match="the cable"):
        await task


async def test_a_stream_is_kept_value_by_value(store: RunStore, clock: ManualClock) -> None:
    counter = StreamedCounter(clock)
    clock.advance(100.0)
    recorder = Recorder(counter, store, clock, KEY, 25.0)
    counter.send(99.0)
    async with recorder_at_work(recorder):
        await asyncio.sleep(0)
        times = [100.0 + n / 1000.0 for n in range(25_000)]
        for second in range(25):
            counter.send(*times[1000 * second : 1000 * (second + 1)])
            await asyncio.sleep(0)
        assert recorder.newest(2) == [
            pytest.approx((24.998, 124.998e-6)),
            pytest.approx((24.999, 124.999e-6)),
        ]
    counter.send(125.0)
    row = row_of(recorder.recorded(replace(counter.beam, values_lost=True), 1.0, 0.0))
    await store.append_step(KEY[0], KEY[1], "A1", {}, [(Recorded.table, row)])
    assert readings(store) == [(time_s - 100.0, time_s * 1e-6) for time_s in times]
    assert (row["method"], row["asked_hz"], row["values_lost"]) == ("streamed", None, 1)
    assert row["rate_hz"] == pytest.approx(1000.0)


async def test_a_disk_that_falls_behind_ends_the_recording(
    store: RunStore, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_MOST_WAITING", 100)
    counter = StreamedCounter(clock)
    recorder = Recorder(counter, store, clock, KEY, 25.0)

    async def record_on() -> None:
        async with recorder_at_work(recorder):
            await asyncio.sleep(0)
            counter.send(*(n / 1000.0 for n in range(200)))

    with pytest.raises(StorageError, match=r"100 readings of recording series wait .* on a local disk"):
        await record_on()


async def test_a_recording_counts_with_its_step(parts: Parts) -> None:
    await parts.ctx.zero(100.0)

    async def action() -> Row:
        async with parts.ctx.recording("series") as recording:
            assert recording.name == "series"
            await parts.ctx.pause(5.0)
            assert parts.reader.recordings() == []
        return {}

    await parts.ctx.step("A1", "record", action)
    (row,) = parts.reader.recordings()
    assert (row["step_id"], row["attempt"], row["name"]) == ("A1", 1, "series")
    assert (row["beam_lost"], row["scale"], row["offset_mm"]) == (0, 1.0, 0.0)
    assert verify(parts.reader.path).problems == ()


async def test_a_count_that_nobody_zeroed_is_a_lost_beam(parts: Parts) -> None:
    async def action() -> Row:
        async with parts.ctx.recording("series"):
            await parts.ctx.pause(1.0)
        return {}

    await parts.ctx.step("A1", "record", action)
    assert parts.reader.recordings()[0]["beam_lost"] == 1


async def test_a_dropped_step_takes_its_recording_along(parts: Parts) -> None:
    async def broken() -> Row:
        async with parts.ctx.recording("series"):
            await parts.ctx.pause(11.0)
            raise LinkError("the robot is gone")

    async def whole() -> Row:
        async with parts.ctx.recording("series"):
            await parts.ctx.pause(1.0)
        return {}

    with pytest.raises(LinkError):
        await parts.ctx.step("A1", "record", broken)
    await parts.ctx.step("A1", "record", whole)
    assert [row["attempt"] for row in parts.reader.recordings()] == [2]
    found = verify(parts.reader.path)
    assert found.problems == ()
    # Eleven seconds of them, and those that came while the disk wrote.
    left = re.match(r"(\d+) readings of recording series belong to an attempt at step A1", found.notes[1])
    assert left is not None
    assert 275 <= int(left[1]) < 300


async def test_recordings_neither_nest_nor_stand_alone(parts: Parts) -> None:
    with pytest.raises(RuntimeError, match="outside of a step"):
        async with parts.ctx.recording("series"):
            pass

    async def nested() -> Row:
        async with parts.ctx.recording("series"), parts.ctx.recording("other"):
            pass
        return {}

    with pytest.raises(RuntimeError, match="other begins while series is under way"):
        await parts.ctx.step("A1", "record", nested)
