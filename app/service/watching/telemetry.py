"""For those who watch: the bench and its samples, and what goes over the wires; at most five times a second."""

import asyncio
import logging
import shutil
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Literal, Protocol

from catseye.app.engine.devices import DeviceBuilder, Devices, WireRecorder
from catseye.app.engine.handle import RunHandle
from catseye.app.engine.waiting import cancel
from catseye.app.protocol.bench import BenchStatus
from catseye.app.protocol.engine_events import BenchSeen, SamplesTaken, WirePassed
from catseye.app.service.watching.bench_facts import BenchFacts
from catseye.app.service.watching.bench_status import bench_status
from catseye.app.service.watching.latest_values import LatestValues
from catseye.app.service.watching.observed_devices import observed
from catseye.app.service.watching.run_sampler import RunSampler
from catseye.app.service.watching.traffic import Traffic
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Entry

_log = logging.getLogger(__name__)

Topic = Literal["watch", "traffic"]

PERIOD_S = 0.2
"""Real seconds between two messages of a kind."""

_DISK_PERIOD_S = 5.0


class Audience(Protocol):
    """The clients of an engine, and what they do."""

    @property
    def run(self) -> RunHandle | None:
        """The run under way."""
        ...

    @property
    def asking(self) -> bool:
        """A question is open."""
        ...

    def listens(self, topic: Topic) -> bool:
        """Return whether anybody receives a topic."""
        ...

    def publish_topic(self, topic: Topic, event: BenchSeen | SamplesTaken | WirePassed) -> None:
        """Send an event to everybody who receives a topic."""
        ...


def free_bytes(folder: Path) -> int | None:
    """Return the free space of the disk that a folder is, or will be, on; None when that is not known."""
    try:
        there = next(place for place in (folder, *folder.absolute().parents) if place.exists())
        return shutil.disk_usage(there).free
    except OSError:
        return None


async def free_bytes_aside(folder: Path) -> int | None:
    """Return the free space likewise, in a thread: a disk on a network may take its time."""
    return await asyncio.to_thread(free_bytes, folder)


class Telemetry:
    """Keeps the bench's latest values and publishes them while somebody watches.

    Args:
        clock: real time.
        root: folder of the runs, whose disk is looked at.
        look_at_disk: returns the free bytes of the disk of a folder, however long that takes.

    Attributes:
        latest: of the bench.
        traffic: of the links.
        facts: of the bench that is watched; None until one is known.
        prepare: sees to it that the facts of the bench are known; raises RefusedError when they cannot be.
        on_watched: called with whether anybody watches, when that changes.
    """

    def __init__(
        self,
        audience: Audience,
        clock: Clock,
        root: Path,
        look_at_disk: Callable[[Path], Awaitable[int | None]] = free_bytes_aside,
    ) -> None:
        self.latest = LatestValues(clock)
        self.traffic = Traffic(clock)
        self.facts: BenchFacts | None = None
        self.prepare: Callable[[], None] = lambda: None
        self.on_watched: Callable[[bool], None] = lambda _watched: None
        self._audience = audience
        self._clock = clock
        self._root = root
        self._free_on_disk = look_at_disk
        self._free_bytes: int | None = None
        self._sampler = RunSampler(self.latest, clock)
        self._task: asyncio.Task[None] | None = None

    def describe(self, facts: BenchFacts) -> None:
        """Take the facts of the bench that is watched from now on; another bench's values are forgotten."""
        if self.facts is None or (facts.cell, facts.devices) != (self.facts.cell, self.facts.devices):
            self.latest.clear()
        self.facts = facts

    def observe(self, facts: BenchFacts, build: DeviceBuilder) -> DeviceBuilder:
        """Return a builder of a run's devices whose answers and traffic are seen here.

        Args:
            facts: of the run's bench, which is the one that is watched from now on.
        """
        self.describe(facts)
        # Those of the run before are closed.
        self._sampler.devices = None

        def built(record: WireRecorder) -> Devices:
            def both(device: str, entry: Entry, data: bytes) -> None:
                record(device, entry, data)
                self.traffic.record(device, entry, data)

            devices = observed(build(both), self.latest, facts.material)
            self._sampler.devices = devices
            return devices

        return built

    def bench(self) -> BenchStatus | None:
        """Return the bench as it is now; None when none is known."""
        if self.facts is None:
            return None
        run = self._audience.run
        return bench_status(
            self.facts if run is None else self.facts.turned(run.turned_deg),
            self.latest,
            moving=run is not None and run.control.moving,
            simulated=None if run is None else run.simulated,
            free_bytes=self._free_bytes,
        )

    def wake(self) -> None:
        """Begin to publish, or to publish more; somebody has asked for it."""
        self.traffic.listening = self._audience.listens("traffic")
        if self._task is None or self._task.done():
            # What came while nobody watched is no news.
            self.latest.columns.take(self._clock.monotonic_s())
            self._task = asyncio.create_task(self._serve())
            self.on_watched(True)

    def publish(self) -> None:
        """Publish what has come since the last time."""
        audience, run = self._audience, self._audience.run
        self.traffic.listening = audience.listens("traffic")
        if (wire := self.traffic.take()) is not None:
            audience.publish_topic("traffic", wire)
        if not audience.listens("watch"):
            return
        if run is not None:
            self._sampler.tick(run.control, asking=audience.asking)
        if (bench := self.bench()) is not None:
            audience.publish_topic("watch", BenchSeen(**dict(bench)))
        audience.publish_topic("watch", self._samples())

    async def end(self) -> None:
        """Publish no more."""
        if self._task is not None:
            await cancel(self._task)

    async def _serve(self) -> None:
        """Publish until nobody listens. Nothing is waited for after that was seen: the next `wake` begins anew."""
        disk, failed = asyncio.create_task(self._look_at_disk()), False
        try:
            while self._audience.listens("watch") or self._audience.listens("traffic"):
                try:
                    self.publish()
                    failed = False
                except Exception:  # noqa: BLE001  # values that are not published grow old where they are shown
                    if not failed:
                        _log.exception("the bench could not be published")
                    failed = True
                await self._clock.sleep(PERIOD_S)
        finally:
            disk.cancel()
            self.traffic.listening = False
            self.on_watched(False)

    def _samples(self) -> SamplesTaken:
        columns = self.latest.columns
        taken = columns.take(self._clock.monotonic_s())
        return SamplesTaken(
            quantity="displacement_mm",
            period_s=columns.period_s,
            low=tuple(taken.low),
            high=tuple(taken.high),
            count=tuple(taken.count),
            missed=taken.missed,
        )

    async def _look_at_disk(self) -> None:
        while True:
            self._free_bytes = await self._free_on_disk(self._root)
            await self._clock.sleep(_DISK_PERIOD_S)
