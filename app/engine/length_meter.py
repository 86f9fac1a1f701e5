"""The length counter of a run: distances at standstill, zeros and recordings, corrected for the air."""

from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import replace

from catseye.app.cell.model import Air
from catseye.app.engine.compensation import missing_quantities
from catseye.app.engine.devices import Devices
from catseye.app.engine.measuring import AirCache, Lengths, lengths_of, measure, unless_dark
from catseye.app.engine.recorder import Recorder, recorder_at_work
from catseye.app.errors import ConfigError
from catseye.app.store.chunks import Key
from catseye.app.store.run_store import RunStore
from catseye.drivers.roles.air import AirSample
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.interferometer import BeamStatus
from catseye.procedures.kit.context import Measurement
from catseye.procedures.kit.recording import Recorded

_MATERIAL_MAX_AGE_S = 30.0
"""Links warm up slowly."""


class LengthMeter:
    """Measures and records with the interferometer of a run.

    Args:
        air: how the program corrects for the air where the instrument does not.
        warn: stores and publishes a warning.
        waited: called with the length of each dwell, s.

    Attributes:
        zeroed: this process has zeroed the count, and nobody was at the bench since: until then no reading is ok.
        recorder: at work; None while nothing is recorded.
    """

    def __init__(
        self,
        devices: Devices,
        clock: Clock,
        air: Air,
        warn: Callable[[str], Awaitable[None]],
        waited: Callable[[float], None],
    ) -> None:
        self.zeroed = False
        self.recorder: Recorder | None = None
        self._devices = devices
        self._clock = clock
        self._warn = warn
        self._waited = waited
        self._stated = lengths_of(devices, clock, air)
        self._material = devices.material and AirCache(devices.material, clock, _MATERIAL_MAX_AGE_S)
        self._doubts: set[str] = set()

    @property
    def lengths(self) -> Lengths:
        """What distances are measured with.

        Raises:
            ConfigError: the cell has no device for it.
        """
        if self._stated is None:
            raise ConfigError(
                "this procedure needs [interferometer] and [environment] and the cell file lacks one of them; add it"
            )
        return self._stated

    async def status(self) -> BeamStatus:
        """Return the state of the beam now."""
        return await self.lengths.counter.status()

    async def measure(self, dwell_time_s: float, readings: int) -> Measurement:
        """Average readings over a dwell."""
        measured = await measure(
            self._devices.robot, self.lengths, self._clock, dwell_time_s, readings, self._waited
        )
        await self._warn_of_doubt(measured.air)
        await self._warn_of_strays(measured.apart, readings)
        material_c = (await self._material.get()).temperature_c if self._material else None
        return replace(measured, beam=self._watched(measured.beam), material_c=material_c)

    async def zero(self, dead_path_mm: float) -> int:
        """Zero the count; return the new zero's number."""
        lengths = self.lengths
        number = await unless_dark(lengths.counter, lengths.counter.zero())
        lengths.compensation.zeroed(await lengths.air.get(), dead_path_mm)
        return number

    @asynccontextmanager
    async def record(
        self, store: RunStore, key: Key, rate_hz: float, keep: Callable[[Recorded], None]
    ) -> AsyncIterator[Recorder]:
        """Record while the body runs.

        Args:
            key: of the recording: step under way, attempt at it, name.
            rate_hz: at which a counter is asked that sends nothing by itself.
            keep: called at the end with what is to be stored with the step.

        Raises:
            RuntimeError: another recording is under way.
        """
        if self.recorder is not None:
            raise RuntimeError(f"recording {key[2]} begins while {self.recorder.name} is under way")
        lengths = self.lengths
        before = await self._correction()
        self.recorder = recorder = Recorder(lengths.counter, store, self._clock, key, rate_hz)
        try:
            async with recorder_at_work(recorder):
                yield recorder
            after = await self._correction()
        finally:
            self.recorder = None
        scale, offset_mm = ((first + last) / 2.0 for first, last in zip(before, after, strict=True))
        keep(recorder.recorded(self._watched(await self.status()), scale, offset_mm))

    async def _correction(self) -> tuple[float, float]:
        """Return by what a reading is multiplied and what is added, mm, to correct it for the air as it is now."""
        lengths = self.lengths
        air = await lengths.air.get()
        await self._warn_of_doubt(air)
        offset_mm, one_mm = (
            lengths.compensation.correct(raw_mm, air).displacement_mm for raw_mm in (0.0, 1.0)
        )
        return one_mm - offset_mm, offset_mm

    def _watched(self, status: BeamStatus) -> BeamStatus:
        """Return a state of the beam in which nobody's watching the count is a lost beam."""
        return replace(status, beam_lost=status.beam_lost or not self.zeroed)

    async def _warn_of_doubt(self, air: AirSample) -> None:
        """Warn once of each thing that is wrong with the samples of the air."""
        kind = ", ".join(missing_quantities(air)) or "range"
        doubt = None if kind in self._doubts else self.lengths.compensation.doubt(air)
        if doubt is not None:
            self._doubts.add(kind)
            await self._warn(doubt)

    async def _warn_of_strays(self, strays: tuple[str, ...], readings: int) -> None:
        """Warn of readings that were left out."""
        if not strays:
            return
        verb = "stands" if len(strays) == 1 else "stand"
        await self._warn(
            f"{len(strays)} of {readings} readings {verb} apart from the others: {', '.join(map(repr, strays))}; "
            "left out: a digit was lost or changed on the line, or something shook the beam; check the "
            "interferometer's cable, connectors and shielding"
        )
