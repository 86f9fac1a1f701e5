"""uMD1 and uMD2: open displays that stream counts and take no commands; zeroing is done here."""

from collections import deque
from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import ClassVar, Literal

from pydantic import Field

from catseye.drivers.links.driver import DeviceSettings, LinkDriver
from catseye.drivers.links.latches import Latches
from catseye.drivers.links.stream import StreamLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import LinkTimeoutError, RefusedError, WrongDeviceError
from catseye.drivers.roles.interferometer import (
    BeamStatus,
    Compensated,
    LengthReading,
    StreamedInterferometer,
)
from catseye.drivers.umd import codec

MODEL = "uMD display"


class UmdSettings(DeviceSettings):
    """What a cell file may set. Times are real seconds."""

    axis: Literal[1, 2, 3] = Field(default=1, description="1, 2 or 3.")
    vacuum_wavelength_nm: float = Field(
        default=632.9908,
        gt=200,
        lt=3000,
        description="of the laser, nm; lengths are counted in vacuum wavelengths.",
    )
    multiplier: Literal[1, 2, 4] = Field(default=1, description="of the optics: 1, 2 (plane mirror) or 4.")
    sign: Literal[1, -1] = Field(
        default=1, description="-1 when the count falls while the beam grows longer."
    )
    ring_samples: int = Field(default=8192, ge=16, description="newest samples that are kept for `samples`.")
    timeout_s: float = Field(default=1.0, gt=0, description="for the next sample of the stream.")
    connect_timeout_s: float = Field(default=5.0, gt=0, description="for connecting.")


@dataclass(frozen=True, slots=True)
class TimedSample:
    """One sample of the stream.

    Attributes:
        displacement_mm: since the last zero, growing with the beam, in vacuum wavelengths, mm.
        time_s: arrival of its last byte, on the driver's clock, s.
        sample: as it came.
    """

    displacement_mm: float
    time_s: float
    sample: codec.Sample


class UmdDisplay(LinkDriver, StreamedInterferometer):
    """Interferometer driver. The display gives no signal level: it is 1 with and 0 without a beam.

    Args:
        transport: the connection: the display's virtual serial port, or a socket.

    Attributes:
        lost_samples: samples that were missing in the stream so far.
    """

    Settings: ClassVar[type[UmdSettings]] = UmdSettings
    summary: ClassVar[str] = "µMD interferometer display, serial"

    def __init__(self, transport: Transport, clock: Clock, settings: UmdSettings | None = None) -> None:
        self._settings = settings or UmdSettings()
        self._mm_per_count = (
            self._settings.sign * self._settings.vacuum_wavelength_nm * 1e-6 / 2 / self._settings.multiplier
        )
        self._latches = Latches()
        self._ring: deque[tuple[codec.Sample, float]] = deque(maxlen=self._settings.ring_samples)
        self._count = 0
        self._zero_counts = 0.0
        self._last_sequence: int | None = None
        self._low: dict[int, int] = {}
        self.lost_samples = 0
        self._link = StreamLink(
            transport, clock, name=MODEL, decoder=codec.SampleDecoder, take=self._take, greet=self._greet
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know about this counter."""
        return ("the display reports no signal level: it is shown as 1 with and 0 without a beam",)

    @property
    def numbers_values(self) -> bool:
        """Every line carries the number of its sample."""
        return True

    @property
    def compensated(self) -> Compensated:
        """Never by the instrument: it counts wavelengths."""
        return "none"

    @property
    def count_mm(self) -> float:
        """Displacement that 1 in the instrument's number means, by the settings, mm."""
        return self._mm_per_count

    async def connect(self) -> Identity:
        """Open the link and wait for one cycle of samples.

        Raises:
            WrongDeviceError: what comes is no stream of samples, or has no such axis.
            LinkError: unreachable or silent.
        """
        await self._link.open()
        firmware = str(self._low.get(codec.FIRMWARE, ""))
        simulated = self._low.get(codec.NOTHING) == codec.EMULATOR_MARK
        return Identity(model=MODEL, firmware=firmware, serial="", simulated=simulated)

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        await self._link.close()

    async def zero(self) -> int:
        """Take the next sample as zero, clear the latched faults; return the new zero's number.

        Raises:
            RefusedError: no beam returns.
            LinkError: lost, or the stream has stopped.
        """
        await self._link.ensure()
        sample, _ = await self._next()
        if not self._returns(sample):
            raise RefusedError(f"{self._link.where}: no zero, no beam returns: aim the beam first", 0)
        self._zero_counts = self._axis(sample).counts
        return self._latches.zeroed()

    async def read(self) -> LengthReading:
        """Return the first sample that arrives after this call.

        Raises:
            LinkError: lost, or the stream has stopped.
        """
        await self._link.ensure()
        sample, time_s = await self._next()
        raw = f"{self._axis(sample).counts:.3f} counts"
        return LengthReading(self._length_mm(sample), raw, time_s, self._latches.zero_id)

    async def status(self) -> BeamStatus:
        """Return the state of the beam.

        Raises:
            LinkError: lost, or the stream has stopped.
        """
        await self._link.ensure()
        sample, _ = await self._next()
        returns = self._returns(sample)
        return BeamStatus(
            beam_ok=returns,
            beam_lost=self._latches.beam_lost,
            overspeed=self._latches.overspeed,
            laser_ready=sample.reference > 0,
            signal=1.0 if returns else 0.0,
            values_lost=self._latches.values_lost,
            zero_id=self._latches.zero_id,
        )

    async def samples(self) -> AsyncIterator[TimedSample]:
        """Yield every sample from now on, each once and in order; ends only with an error or the caller.

        A caller that falls behind by more than the ring loses the oldest; they are counted as lost.

        Raises:
            LinkError: lost, or the stream has stopped.
        """
        await self._link.ensure()
        taken = self._count
        while True:
            await self._link.wait(lambda: self._count > taken, self._settings.timeout_s, "sample")  # noqa: B023  # awaited at once
            fallen = self._count - taken - len(self._ring)
            if fallen > 0:
                self._note_lost(fallen)
                taken += fallen
            fresh = self._newest(self._count - taken)
            taken = self._count
            for sample, time_s in fresh:
                yield TimedSample(self._length_mm(sample), time_s, sample)

    def _newest(self, count: int) -> list[tuple[codec.Sample, float]]:
        return [self._ring[k] for k in range(-count, 0)]

    def _axis(self, sample: codec.Sample) -> codec.Axis:
        return sample.axes[self._settings.axis - 1]

    def _returns(self, sample: codec.Sample) -> bool:
        return sample.reference > 0 and self._axis(sample).measured > 0

    def _length_mm(self, sample: codec.Sample) -> float:
        return (self._axis(sample).counts - self._zero_counts) * self._mm_per_count

    def _take(self, sample: codec.Sample, time_s: float) -> None:
        if len(sample.axes) < self._settings.axis:
            return
        if self._last_sequence is not None:
            missing = codec.missing(self._last_sequence, sample.sequence)
            if missing is None:
                # The display has started anew, and its count with it.
                self._latches.note(beam_lost=True)
            elif missing:
                self._note_lost(missing)
        self._last_sequence = sample.sequence
        self._low[sample.low_code] = sample.low_data
        self._latches.note(beam_lost=not self._returns(sample))
        self._ring.append((sample, time_s))
        self._count += 1
        if self._on_value is not None:
            self._on_value(time_s, self._length_mm(sample))

    def _note_lost(self, count: int) -> None:
        self.lost_samples += count
        self._latches.note(values_lost=True)

    async def _next(self) -> tuple[codec.Sample, float]:
        """Return the next sample to arrive."""
        before = self._count
        await self._link.wait(lambda: self._count > before, self._settings.timeout_s, "sample")
        return self._ring[-1]

    async def _greet(self) -> None:
        self._latches.greeting()
        self._last_sequence = None
        self._low.clear()
        enough = self._count + codec.CYCLE
        try:
            await self._link.wait(lambda: self._count >= enough, self._settings.timeout_s, "samples")
        except LinkTimeoutError as exc:
            if not self._link.last_bytes or self._ring:
                raise
            raise WrongDeviceError(
                f"{self._link.where}: what comes here are not samples of a {MODEL} with axis {self._settings.axis}: "
                f"check the port and the setting axis; {exc}"
            ) from None
        self._latches.greeted()
