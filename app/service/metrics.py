"""`--metrics FILE`: how a run fares, for programs that watch many machines; nothing of the run waits for the file."""

import asyncio
import logging
import math
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Final

from catseye.app.engine.announcer import Publish
from catseye.app.engine.handle import RunHandle
from catseye.app.engine.waiting import cancel, within
from catseye.app.errors import StorageError, UsageError
from catseye.app.files.atomic import require_output, write_atomically
from catseye.app.protocol.run_events import (
    LiveData,
    LiveShown,
    PointMeasured,
    Progressed,
    PromptAnswered,
    PromptAsked,
    RunEnded,
    RunEvent,
    StateChanged,
    StepDone,
    WarningIssued,
)
from catseye.app.protocol.state import ControlState
from catseye.app.service.aside import aside
from catseye.app.service.openmetrics import Family, Sample, exposition
from catseye.drivers.roles.air import AirSample
from catseye.drivers.roles.clock import Clock

_log = logging.getLogger(__name__)

PERIOD_S: Final = 1.0
"""Real s between two files at least."""

STALE_S: Final = 10.0
"""After so long the file is written even without news, real s: its time says that the run lives."""

LAST_WRITE_S: Final = 5.0
"""For the last file; a disk that does not answer keeps nobody waiting."""

_MOST_QUANTITIES: Final = 50
"""Live quantities at a time; the oldest is left out."""


@dataclass
class _Deviations:
    """Sum of squares of a quantity that should be zero."""

    count: int = 0
    squares: float = 0.0

    def add(self, value: float) -> None:
        self.count += 1
        self.squares += value * value

    @property
    def rms(self) -> float:
        return math.sqrt(self.squares / self.count)


@dataclass
class RunValues:
    """What the events of a run say, as numbers."""

    state: ControlState | None = None
    points: int = 0
    steps: int = 0
    warnings: int = 0
    asking: bool = False
    progress: Progressed | None = None
    ended: RunEnded | None = None
    live: dict[str, LiveData] = field(default_factory=dict)
    _deviations: dict[str, _Deviations] = field(default_factory=dict)

    def take(self, event: RunEvent) -> None:
        """Take an event."""
        match event:
            case StateChanged():
                self.state = event.state
            case PointMeasured():
                self.points += 1
            case StepDone(stored=False):
                self.steps += 1
            case WarningIssued():
                self.warnings += 1
            case PromptAsked():
                self.asking = True
            case PromptAnswered():
                self.asking = False
            case Progressed():
                self.progress = event
            case LiveShown():
                self._take_live(event.data)
            case RunEnded():
                self.ended, self.asking = event, False
            case _:
                pass

    def families(self) -> Iterator[Family]:
        """Yield what is known."""
        yield Family("catseye_run_state", "stateset", "State of the run.", tuple(self._states()))
        yield _counter("catseye_run_points", "Points measured by this process.", self.points)
        yield _counter("catseye_run_steps", "Steps done by this process.", self.steps)
        yield _counter("catseye_run_warnings", "Warnings of this process.", self.warnings)
        yield _gauge("catseye_run_prompt_open", "1 while a question waits for an answer.", float(self.asking))
        progress, ended = self.progress, self.ended
        yield _gauge(
            "catseye_run_progress_ratio",
            "Share that is done.",
            None if progress is None else progress.share,
            "ratio",
        )
        yield _gauge(
            "catseye_run_elapsed_seconds",
            "Real time since the beginning.",
            None if progress is None else progress.elapsed_s,
            "seconds",
        )
        yield _gauge(
            "catseye_run_left_seconds",
            "Estimated real time left.",
            None if progress is None else progress.left_s,
            "seconds",
        )
        yield _gauge(
            "catseye_run_exit_code",
            "Exit code, once the run has ended.",
            None if ended is None else ended.exit_code,
        )
        yield from self._live_families()

    def _states(self) -> Iterator[Sample]:
        if self.state is not None:
            for state in ControlState:
                yield Sample(float(state is self.state), {"catseye_run_state": state.value})

    def _take_live(self, data: LiveData) -> None:
        self.live.pop(data.name, None)
        self.live[data.name] = data
        # A band about zero is that of a deviation, such as an innovation.
        if data.low is not None and data.high == -data.low and math.isfinite(data.value):
            self._deviations.setdefault(data.name, _Deviations()).add(data.value)
        if len(self.live) > _MOST_QUANTITIES:
            oldest = next(iter(self.live))
            del self.live[oldest]
            self._deviations.pop(oldest, None)

    def _live_families(self) -> Iterator[Family]:
        live, deviations = self.live, self._deviations
        yield Family(
            "catseye_live",
            "gauge",
            "Latest value of what is watched, an uncertainty among them.",
            tuple(Sample(data.value, _quantity(data)) for data in live.values()),
        )
        yield Family(
            "catseye_live_expanded_uncertainty",
            "gauge",
            "Uncertainty U (k = 2) of the latest value.",
            tuple(Sample(data.expanded, _quantity(data)) for data in live.values() if data.expanded),
        )
        yield Family(
            "catseye_live_rms",
            "gauge",
            "Root mean square of a deviation, such as the innovations, since the process began.",
            tuple(Sample(deviations[name].rms, _quantity(live[name])) for name in live if name in deviations),
        )


_NO_AIR: Final = AirSample(None, None, None)


@dataclass(frozen=True)
class Surroundings:
    """Where the values come from that no event says; each is asked beside the loop.

    Attributes:
        air: latest sample; None before there is one.
        heals: how often each link was healed, by device and endpoint.
        free_bytes: of the disk of the runs; None when that is not known.
    """

    air: Callable[[], AirSample | None]
    heals: Callable[[], Mapping[str, int]]
    free_bytes: Callable[[], int | None]

    def families(self) -> Iterator[Family]:
        """Yield what is known."""
        air = self.air() or _NO_AIR
        yield _gauge("catseye_air_celsius", "Temperature of the air.", air.temperature_c, "celsius")
        yield _gauge("catseye_air_hectopascals", "Pressure of the air.", air.pressure_hpa, "hectopascals")
        yield _gauge("catseye_air_humidity_percent", "Relative humidity.", air.humidity_percent, "percent")
        healed = tuple(Sample(float(count), {"link": link}) for link, count in sorted(self.heals().items()))
        yield Family("catseye_link_heals", "counter", "How often a link was healed.", healed)
        yield _gauge(
            "catseye_runs_free_bytes", "Free space on the disk of the runs.", self.free_bytes(), "bytes"
        )


class MetricsFile:
    """Writes the state of one run: at most once a second, and at its end.

    Args:
        path: file that is replaced.
        labels: of every value.
        surroundings: what no event says.
        clock: real time.
        write: replaces the file; raises StorageError.
    """

    def __init__(
        self,
        path: Path,
        labels: Mapping[str, str],
        surroundings: Surroundings,
        clock: Clock,
        write: Callable[[Path, str], None] = write_atomically,
    ) -> None:
        self._path = path
        self._labels = dict(labels)
        self._surroundings = surroundings
        self._clock = clock
        self._write = write
        self._values = RunValues()
        self._news = True
        self._failed = False
        self._writing: asyncio.Task[None] | None = None

    def before(self, publish: Publish) -> Publish:
        """Return what takes the events of the run here first, and then there."""

        def both(event: RunEvent) -> None:
            self._values.take(event)
            self._news = True
            publish(event)

        return both

    @asynccontextmanager
    async def kept(self, handle: RunHandle) -> AsyncIterator[None]:
        """Keep the file up to date while a run's record is open, and leave it as the run ended."""
        self._labels["run"] = handle.path.name
        task = asyncio.create_task(self._keep(handle.warn))
        try:
            yield
        finally:
            await cancel(task)
            await self._write_last()

    async def _keep(self, warn: Callable[[str], None]) -> None:
        written_s = -math.inf
        while True:
            now_s = self._clock.monotonic_s()
            if self._news or now_s - written_s >= STALE_S:
                written_s, self._news = now_s, False
                self._writing = asyncio.create_task(self._replace(warn))
                await asyncio.shield(self._writing)
            await self._clock.sleep(PERIOD_S)

    async def _write_last(self) -> None:
        try:
            await within(self._clock, LAST_WRITE_S, self._replace_at_last())
        except TimeoutError:
            _log.warning("%s: the disk does not answer; the file does not say how the run ended", self._path)

    async def _replace_at_last(self) -> None:
        if self._writing is not None:
            # An older file that comes late would replace the last one.
            await asyncio.wait({self._writing})
        await self._replace(_log.warning)

    async def _replace(self, warn: Callable[[str], None]) -> None:
        """Write the file; the first failure is a warning, and further ones say nothing new."""
        families, now = tuple(self._values.families()), self._clock.now_utc()
        try:
            await aside(partial(self._render_and_write, families, now))
        except StorageError as error:
            if not self._failed:
                self._failed = True
                warn(f"the metrics are not written, and the run goes on: {error}")

    def _render_and_write(self, families: tuple[Family, ...], now: datetime) -> None:
        written = _gauge(
            "catseye_written_timestamp_seconds", "When this was written.", now.timestamp(), "seconds"
        )
        self._write(
            self._path, exposition((*families, *self._surroundings.families(), written), self._labels)
        )


def require_metrics_file(path: Path | None, *inputs: Path | None) -> None:
    """Refuse a place where no metrics can be written, before the run begins.

    Args:
        inputs: files that are read; None for those that are not given.

    Raises:
        UsageError: it is one of the inputs, a folder, or no regular file: a pipe would be waited for.
        StorageError: its folder is missing.
    """
    require_output(path, *inputs)
    if path is not None and path.exists() and not path.is_file():
        raise UsageError(
            f"{path}: is no regular file, and metrics are a file that is replaced; give another name"
        )


def _quantity(data: LiveData) -> dict[str, str]:
    return {"quantity": data.name, "unit": data.unit}


def _counter(name: str, text: str, value: int) -> Family:
    return Family(name, "counter", text, (Sample(float(value), {}),))


def _gauge(name: str, text: str, value: float | None, unit: str = "") -> Family:
    return Family(name, "gauge", text, () if value is None else (Sample(float(value), {}),), unit)
