"""Lasertex HPI-3D: a laser interferometer that streams distances at about 25 Hz."""

import asyncio
from typing import ClassVar, Literal

from pydantic import Field

from catseye.drivers.lasertex import codec
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

MODEL = "Lasertex HPI-3D"


class HpiSettings(DeviceSettings):
    """What a cell file may set. Times are real seconds."""

    sign: Literal[1, -1] = Field(
        default=1, description="-1 when the distance falls while the beam grows longer."
    )
    compensated: Literal["none", "instrument"] = Field(
        default="none",
        description="`instrument` when the distances are corrected for the air by the instrument; no public source "
        "says that they are.",
    )
    signal_full_scale: int = Field(
        default=100, gt=0, le=255, description="level that means 1; the level's unit is not published."
    )
    timeout_s: float = Field(
        default=1.0, gt=0, description="for an acknowledgement, and for the next distance of the stream."
    )
    connect_timeout_s: float = Field(default=5.0, gt=0, description="for connecting.")


class LasertexHpi(LinkDriver, StreamedInterferometer):
    """Interferometer driver.

    Args:
        transport: the connection; the instrument's virtual serial port runs at 3000000 baud, 8N1.
    """

    Settings: ClassVar[type[HpiSettings]] = HpiSettings
    summary: ClassVar[str] = "Lasertex HPI-3D, serial"

    def __init__(self, transport: Transport, clock: Clock, settings: HpiSettings | None = None) -> None:
        self._settings = settings or HpiSettings()
        self._latches = Latches()
        self._lock = asyncio.Lock()
        self._acknowledged: dict[int, bytes] = {}
        self._newest: tuple[codec.Distance, float] | None = None
        self._count = 0
        self._simulated = False
        self._link = StreamLink(
            transport, clock, name=MODEL, decoder=codec.FrameDecoder, take=self._take, greet=self._greet
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know about this counter."""
        return ()

    @property
    def compensated(self) -> Compensated:
        """Who corrects the lengths for the air."""
        return self._settings.compensated

    @property
    def count_mm(self) -> float:
        """Displacement that 1 in the instrument's number means, by the settings, mm."""
        return self._settings.sign * codec.MM_PER_COUNT

    async def connect(self) -> Identity:
        """Open the link, start the stream of distances and wait for the first.

        Raises:
            WrongDeviceError: something else answers.
            LinkError: unreachable or silent.
        """
        await self._link.open()
        return Identity(model=MODEL, firmware="", serial="", simulated=self._simulated)

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        await self._link.close()

    async def zero(self) -> int:
        """Zero the count, clear the latched faults; return the new zero's number.

        Raises:
            RefusedError: no beam returns.
            LinkError: lost or silent.
        """
        async with self._lock:
            await self._link.ensure()
            for code in (codec.CLEAR_SMALL_SIGNAL, codec.CLEAR_OVERSPEED):
                await self._order(code)
            # From here on the old count is gone, even if the caller gives up before the new one is there.
            self._latches.note(beam_lost=True)
            await self._order(codec.ZERO)
            distance, _ = await self._next()
            if not distance.signal_ok:
                raise RefusedError(
                    f"{self._link.where}: no zero, the signal is too small (level {distance.level}): "
                    "aim the beam first",
                    0,
                )
            return self._latches.zeroed()

    async def read(self) -> LengthReading:
        """Return the first distance that arrives after this call.

        Raises:
            LinkError: lost, or the stream has stopped.
        """
        await self._link.ensure()
        distance, time_s = await self._next()
        value_mm = self._settings.sign * distance.length_mm
        return LengthReading(value_mm, f"{distance.count} x 100 pm", time_s, self._latches.zero_id)

    async def status(self) -> BeamStatus:
        """Return the state of the beam.

        A flag for a small signal may still be of the past: it is cleared and looked at again.

        Raises:
            LinkError: lost, or the stream has stopped.
        """
        async with self._lock:
            await self._link.ensure()
            distance, _ = await self._next()
            if not distance.signal_ok:
                await self._order(codec.CLEAR_SMALL_SIGNAL)
                distance, _ = await self._next()
        return BeamStatus(
            beam_ok=distance.signal_ok,
            beam_lost=self._latches.beam_lost,
            overspeed=self._latches.overspeed,
            laser_ready=distance.laser_ready,
            signal=min(1.0, distance.level / self._settings.signal_full_scale),
            signal_native=f"{distance.level}",
            zero_id=self._latches.zero_id,
        )

    def _take(self, frame: codec.Frame, time_s: float) -> None:
        if frame.code != codec.DISTANCE:
            self._acknowledged[frame.code] = frame.data
            return
        distance = codec.parse_distance(frame)
        self._latches.note(beam_lost=not distance.signal_ok, overspeed=distance.overspeed)
        self._newest = distance, time_s
        self._count += 1
        if self._on_value is not None:
            self._on_value(time_s, self._settings.sign * distance.length_mm)

    async def _next(self) -> tuple[codec.Distance, float]:
        """Return the next distance to arrive."""
        before = self._count
        await self._link.wait(lambda: self._count > before, self._settings.timeout_s, "distance")
        assert self._newest is not None  # noqa: S101  # the count has grown
        return self._newest

    async def _order(self, code: int) -> bytes:
        """Send a command, which does no harm when it is given again; return the data of its acknowledgement."""
        self._acknowledged.pop(code, None)
        what = f"acknowledgement of {code:04X}"
        await self._link.order(
            codec.command(code), lambda: code in self._acknowledged, self._settings.timeout_s, what
        )
        return self._acknowledged.pop(code)

    async def _greet(self) -> None:
        self._latches.greeting()
        try:
            await self._order(codec.STOP_STREAMS)
            # The data of an acknowledgement mean nothing; an emulator writes there what it is.
            self._simulated = b"EMULATOR" in await self._order(codec.DISTANCE_ON)
            await self._next()
        except LinkTimeoutError as exc:
            if not self._link.last_bytes or self._newest is not None:
                raise
            raise WrongDeviceError(
                f"{self._link.where}: what answers here is not a {MODEL}: check the port in the cell file; {exc}"
            ) from None
        self._latches.greeted()
