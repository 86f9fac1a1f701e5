"""Recording a length counter: every reading is stored as it comes, chunk by chunk, with the time of its arrival."""

import asyncio
import math
from array import array
from collections import deque
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from typing import Final

from catseye.app.engine.waiting import cancel, together, uncancelled
from catseye.app.errors import StorageError
from catseye.app.store.chunks import Chunk, Kept, Key
from catseye.app.store.run_store import RunStore
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import RefusedError
from catseye.drivers.roles.interferometer import BeamStatus, Interferometer
from catseye.procedures.kit.recording import Method, Recorded

CHUNK_S: Final = 10.0
"""Readings of so long at most are lost with a process that dies."""

CHUNK_READINGS: Final = 10_000
"""At most in one chunk, so that a fast stream is stored more often."""

_MOST_WAITING: Final = 50 * CHUNK_READINGS
"""A disk that takes no more for so long has failed; memory stays bounded."""

_NEWEST: Final = 4096
"""Readings that are kept at hand for who watches."""


@dataclass
class Spacing:
    """How evenly readings came, counted as they come.

    Attributes:
        readings: how many.
        first_s: time of the first one.
        last_s: time of the last one.
        longest_s: between two.
    """

    readings: int = 0
    first_s: float = 0.0
    last_s: float = 0.0
    longest_s: float = 0.0
    _squares: float = 0.0

    def add(self, time_s: float) -> None:
        """Count a reading."""
        if self.readings:
            gap_s = time_s - self.last_s
            self.longest_s = max(self.longest_s, gap_s)
            self._squares += gap_s * gap_s
        else:
            self.first_s = time_s
        self.last_s = time_s
        self.readings += 1

    @property
    def duration_s(self) -> float:
        """From the first to the last reading, s."""
        return self.last_s - self.first_s

    @property
    def rate_hz(self) -> float:
        """Mean rate; 0 where there are no two readings."""
        return (self.readings - 1) / self.duration_s if self.duration_s > 0.0 else 0.0

    @property
    def jitter_s(self) -> float:
        """Standard deviation of the time between two readings, s."""
        gaps = self.readings - 1
        if gaps < 1:
            return 0.0
        return math.sqrt(max(0.0, self._squares / gaps - (self.duration_s / gaps) ** 2))


class Recorder:
    """Takes the readings of one recording; implements `catseye.procedures.kit.recording.Recording`.

    Args:
        key: of the recording: step under way, attempt at it, name.
        rate_hz: at which a counter is asked that sends nothing by itself.

    Attributes:
        failure: why no more readings come; None while they do.
    """

    def __init__(
        self, counter: Interferometer, store: RunStore, clock: Clock, key: Key, rate_hz: float
    ) -> None:
        self.failure: Exception | None = None
        self._key = key
        self._counter = counter
        self._store = store
        self._clock = clock
        self._period_s = 1.0 / rate_hz
        self._origin_s = clock.monotonic_s()
        self._origin_utc = clock.now_utc().isoformat()
        self._times, self._values = array("d"), array("d")
        self._kept = Kept()
        self._spacing = Spacing()
        self._newest: deque[tuple[float, float]] = deque(maxlen=_NEWEST)
        self._late = self._lost = 0
        self._due = asyncio.Event()
        self._ending = False

    @property
    def name(self) -> str:
        """Unique in its step."""
        return self._key[2]

    @property
    def readings(self) -> int:
        """How many came so far."""
        return self._spacing.readings

    @property
    def elapsed_s(self) -> float:
        """Time since its origin, s."""
        return self.at(self._clock.monotonic_s())

    def at(self, clock_s: float) -> float:
        """Return a time of the bench's clock as one of the recording, s since its origin."""
        return clock_s - self._origin_s

    def newest(self, count: int) -> list[tuple[float, float]]:
        """Return the newest readings, oldest first: time, s, and displacement, mm, as the instrument gave it."""
        return list(self._newest)[-count:] if count > 0 else []

    def require_going_on(self) -> None:
        """Check that readings are still taken.

        Raises:
            DeviceError: the instrument failed.
            StorageError: they cannot be stored.
        """
        if self.failure is not None:
            raise self.failure

    async def take_in(self) -> None:
        """Take readings until `end` is called."""
        try:
            if self._counter.streams:
                await self._stream()
            else:
                # A disk that takes its time must not keep the counter from being asked.
                await together(self._poll(), self._keep_up())
        except Exception as error:
            self.failure = error
            raise

    def end(self) -> None:
        """Let the reading under way be the last one."""
        self._ending = True
        self._due.set()

    async def keep_the_rest(self) -> None:
        """Store what came since the last chunk."""
        if self._times:
            await self._keep()

    async def keep_what_came(self) -> None:
        """Store what came before a recording was broken off, if it can be stored."""
        # The reason why it was broken off is on its way to the operator; a full disk would only hide it.
        with suppress(StorageError):
            await self.keep_the_rest()

    def recorded(self, status: BeamStatus, scale: float, offset_mm: float) -> Recorded:
        """Return what is to be stored with the step.

        Args:
            status: of the beam after the last reading.
            scale: of a reading, corrected for the air.
            offset_mm: of a reading, corrected for the air.
        """
        spacing, polled = self._spacing, not self._counter.streams
        method: Method = "polled" if polled else "streamed"
        return Recorded(
            name=self.name,
            method=method,
            origin_utc=self._origin_utc,
            origin_clock_s=self._origin_s,
            readings=spacing.readings,
            chunks=self._kept.chunks,
            crc32=self._kept.crc32,
            duration_s=spacing.duration_s,
            rate_hz=spacing.rate_hz,
            asked_hz=1.0 / self._period_s if polled else None,
            jitter_s=spacing.jitter_s,
            longest_gap_s=spacing.longest_s,
            late=self._late,
            lost=self._lost,
            beam_lost=int(status.interrupted),
            overspeed=int(status.overspeed),
            values_lost=int(status.values_lost),
            numbered=int(self._counter.numbers_values),
            scale=scale,
            offset_mm=offset_mm,
        )

    async def _stream(self) -> None:
        """Store what an instrument sends by itself."""
        self._counter.listen(self._take)
        try:
            await self._keep_up()
        finally:
            self._counter.listen(None)

    async def _keep_up(self) -> None:
        """Store what has come, chunk after chunk."""
        while not self._ending:
            await self._due.wait()
            self._due.clear()
            if self._is_due():
                await self._keep()

    async def _poll(self) -> None:
        """Ask at a steady rate. What cannot be asked in time is left out and counted, never made up for."""
        due_s = self._clock.monotonic_s()
        while not self._ending:
            if (wait_s := due_s - self._clock.monotonic_s()) > 0.0:
                await self._clock.sleep(wait_s)
            await self._ask(due_s)
            passed = max(1, math.ceil((self._clock.monotonic_s() - due_s) / self._period_s))
            self._lost += passed - 1
            due_s += passed * self._period_s

    async def _ask(self, due_s: float) -> None:
        try:
            reading = await self._counter.read()
        except RefusedError:
            # Without a beam there is no value; the latch of the beam says so at the end.
            self._lost += 1
            return
        self._late += reading.time_s - due_s > self._period_s / 2.0
        self._take(reading.time_s, reading.displacement_mm)

    def _take(self, time_s: float, displacement_mm: float) -> None:
        """Take a reading; called by drivers, so it neither blocks nor raises."""
        if len(self._times) >= _MOST_WAITING:
            self.failure = self.failure or StorageError(
                f"{len(self._times)} readings of recording {self.name} wait to be stored: the disk is too slow for "
                "this instrument; record on a local disk"
            )
            return
        at_s = self.at(time_s)
        self._times.append(at_s)
        self._values.append(displacement_mm)
        self._newest.append((at_s, displacement_mm))
        self._spacing.add(at_s)
        if self._is_due():
            self._due.set()

    def _is_due(self) -> bool:
        times = self._times
        return bool(times) and (len(times) >= CHUNK_READINGS or times[-1] - times[0] >= CHUNK_S)

    async def _keep(self) -> None:
        # A chunk that is given to the store is stored: broken off, its number would be given twice.
        await uncancelled(self._give())

    async def _give(self) -> None:
        chunk = Chunk(self._times, self._values)
        self._times, self._values = array("d"), array("d")
        number = self._kept.chunks + 1
        self._kept.add(number, await self._store.append_chunk(self._key, number, chunk))


@asynccontextmanager
async def recorder_at_work(recorder: Recorder) -> AsyncIterator[None]:
    """Take readings while the body runs; after it, all that came is stored, also where it was broken off.

    Raises:
        DeviceError: the instrument failed.
        StorageError: a reading could not be stored.
    """
    task = asyncio.create_task(recorder.take_in())
    try:
        yield
        recorder.end()
        await task
        await recorder.keep_the_rest()
        recorder.require_going_on()
    finally:
        try:
            await cancel(task)
        finally:
            await recorder.keep_what_came()
