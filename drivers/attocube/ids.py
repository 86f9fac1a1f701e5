"""attocube IDS3010: three interferometers behind JSON-RPC; this driver uses one axis."""

from functools import partial
from typing import ClassVar, Literal

from pydantic import Field

from catseye.drivers.attocube import codec
from catseye.drivers.links.driver import DeviceSettings, LinkDriver
from catseye.drivers.links.healing import Repeat
from catseye.drivers.links.latches import Latches
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import (
    LinkError,
    LinkTimeoutError,
    ProtocolError,
    RefusedError,
    WrongDeviceError,
)
from catseye.drivers.roles.interferometer import BeamStatus, Compensated, Interferometer, LengthReading

MODEL = "attocube IDS"

_RUNNING = "measurement running"
_STARTING = "measurement starting"
_IDLE = "system idle"
_POLL_S = 0.5
_STARTED = "the measurement was not running and has been started: its laser is on"

_SAME_PM = 1000.0
"""References that differ by less are one and the same."""


class IdsSettings(DeviceSettings):
    """What a cell file may set. Times are real seconds, but for the start."""

    axis: int = Field(default=0, ge=0, le=2, description="0, 1 or 2.")
    dialect: codec.Dialect = Field(
        default="ids",
        description="name space of the methods: `ids` for the IDS3010, `sen` for the newer generation.",
    )
    sign: Literal[1, -1] = Field(
        default=1, description="-1 when the displacement falls while the beam grows longer."
    )
    compensated: Literal["auto", "none", "instrument"] = Field(
        default="auto", description="`auto` asks whether the environment unit corrects for the air."
    )
    start_timeout_s: float = Field(
        default=120.0, gt=0, description="how long the start of a measurement may take, s of the clock."
    )
    timeout_s: float = Field(default=2.0, gt=0, description="for an answer.")
    connect_timeout_s: float = Field(default=5.0, gt=0, description="for connecting.")
    quiet_s: float = Field(default=0.02, gt=0, description="silence after which a link counts as drained.")


class AttocubeIds(LinkDriver, Interferometer):
    """Interferometer driver.

    Args:
        transport: the connection, to TCP port 9090.
    """

    Settings: ClassVar[type[IdsSettings]] = IdsSettings
    summary: ClassVar[str] = "attocube IDS3010 and newer, JSON over TCP"

    def __init__(self, transport: Transport, clock: Clock, settings: IdsSettings | None = None) -> None:
        self._settings = settings or IdsSettings()
        self._clock = clock
        self._latches = Latches()
        self._number = 0
        self._type = ""
        self._firmware = ""
        self._started = False
        self._corrects = False
        self._has_reference = False
        self._reference_pm: float | None = None
        self._link = RequestLink(
            transport,
            name=MODEL,
            greet=self._greet,
            identify=self._recognise,
            quiet_s=self._settings.quiet_s,
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know about this counter."""
        return (_STARTED,) if self._started else ()

    @property
    def compensated(self) -> Compensated:
        """Whether the instrument corrects its lengths for the air; with `auto` known once it is connected."""
        chosen = self._settings.compensated
        if chosen == "auto":
            return "instrument" if self._corrects else "none"
        return chosen

    @property
    def count_mm(self) -> float:
        """Displacement that 1 in the instrument's number means, by the settings, mm."""
        return self._settings.sign * codec.MM_PER_PM

    async def connect(self) -> Identity:
        """Open the link, check who answers; start the measurement if the system is idle.

        Raises:
            WrongDeviceError: something else answers.
            RefusedError: the measurement does not start.
            LinkError: unreachable or silent.
        """
        self._type = ""
        await self._link.open()
        await self._link.repeated(self._start)
        await self._await_start()
        self._corrects = await self._asks_unit()
        self._reference_pm = None
        self._has_reference = await self._knows_reference()
        simulated = "EMULATOR" in f"{self._type}{self._firmware}".upper()
        return Identity(f"attocube {self._type}", self._firmware, "", simulated)

    async def close(self) -> None:
        """Disconnect; may be called any number of times. The measurement goes on."""
        await self._link.close()

    async def zero(self) -> int:
        """Zero the axis, clear the latched faults; return the new zero's number.

        The arm stands still meanwhile: a reset whose answer is lost is sent again, and the last one counts.

        Raises:
            RefusedError: the instrument refuses, in its own words; or its environment unit was switched.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        await self._check_unit()
        if (await self._displacement()).error:
            await self._ask("system.resetError", False)
        await self._link.repeated(self._reset_axis)
        answer = await self._displacement()
        if answer.error:
            raise await self._refused("displacement.getAxisDisplacement", answer.error)
        self._reference_pm = await self._reference()
        return self._latches.zeroed()

    async def read(self) -> LengthReading:
        """Return one reading. With a warning, as without a beam, it is latched as a lost beam.

        Raises:
            RefusedError: the measurement is not running, or there is no value.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        answer = await self._displacement()
        time_s = self._clock.monotonic_s()
        if answer.error:
            await self._check_running()
            if not answer.values:
                raise await self._refused("displacement.getAxisDisplacement", answer.error)
        picometres = self._checked(answer)
        value_mm = self._settings.sign * picometres * codec.MM_PER_PM
        return LengthReading(value_mm, f"{picometres:.0f} pm", time_s, self._latches.zero_id)

    async def status(self) -> BeamStatus:
        """Return the state of the beam. An error that may be of the past is reset and looked at again.

        Raises:
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        answer = await self._displacement()
        if answer.error:
            await self._ask("system.resetError", False)
            answer = await self._displacement()
        await self._look_for_another_zero()
        contrast = await self._ask("adjustment.getContrastInPermille", self._settings.axis)
        permille = contrast.number() if contrast.values else 0.0
        running = await self._mode() == _RUNNING
        return BeamStatus(
            beam_ok=running and not answer.error,
            beam_lost=self._latches.beam_lost,
            overspeed=self._latches.overspeed,
            laser_ready=running,
            signal=min(1.0, max(0.0, permille / 1000.0)),
            signal_native=f"contrast {permille:.0f} ‰",
            zero_id=self._latches.zero_id,
        )

    async def _reset_axis(self) -> None:
        with self._latches.zeroing():
            await self._require("system.resetAxis", self._settings.axis)

    async def _displacement(self) -> codec.Answer:
        answer = await self._ask("displacement.getAxisDisplacement", self._settings.axis)
        self._latches.note(beam_lost=answer.error != 0)
        return answer

    async def _knows_reference(self) -> bool:
        try:
            await self._reference(asks=True)
        except ProtocolError:
            return False
        return True

    async def _reference(self, *, asks: bool = False) -> float | None:
        """Return the position at which the axis was reset or the measurement began, pm; None when it is not given."""
        if not (asks or self._has_reference):
            return None
        if self._settings.dialect == "ids":
            answer, place = await self._ask("displacement.getReferencePositions"), self._settings.axis
        else:
            answer, place = await self._ask("displacement.getReferencePosition", self._settings.axis), 0
        return None if answer.error else answer.number(place)

    async def _look_for_another_zero(self) -> None:
        """Latch a lost beam when somebody else has reset the axis or restarted the measurement since the zero."""
        if self._reference_pm is None:
            return
        now_pm = await self._reference()
        moved = now_pm is not None and abs(now_pm - self._reference_pm) > _SAME_PM
        self._latches.note(beam_lost=moved)

    def _checked(self, answer: codec.Answer) -> float:
        try:
            return answer.number()
        except ProtocolError as exc:
            self._link.distrust("a displacement was no number")
            raise ProtocolError(f"{self._link.where}: {exc}") from None

    async def _mode(self) -> str:
        return (await self._ask("system.getCurrentMode")).text()

    async def _check_running(self) -> None:
        mode = await self._mode()
        if mode != _RUNNING:
            raise RefusedError(
                f"{self._link.where}: no value, the system is in mode {mode!r}: connect again, or start the "
                "measurement in the instrument's web page",
                0,
            )

    async def _start(self) -> None:
        """Start the measurement unless it runs, also by an order of which the answer was lost."""
        if await self._mode() == _IDLE:
            self._started = True
            await self._require("system.startMeasurement")

    async def _await_start(self) -> None:
        """Wait until the measurement runs.

        Raises:
            RefusedError: it does not.
        """
        until_s = self._clock.monotonic_s() + self._settings.start_timeout_s
        while await self._mode() == _STARTING and self._clock.monotonic_s() < until_s:
            await self._clock.sleep(_POLL_S)
        await self._check_running()

    async def _asks_unit(self) -> bool:
        """Return whether the environment unit corrects for the air; an instrument without one does not."""
        name = "isEnabled" if self._settings.dialect == "ids" else "getEnabled"
        answer = await self._ask(f"ecu.{name}")
        return not answer.error and bool(answer.values) and answer.values[0] is True

    async def _check_unit(self) -> None:
        """Refuse when the unit was switched since the connection: lengths would be corrected twice or not at all."""
        if self._settings.compensated == "auto" and await self._asks_unit() != self._corrects:
            raise RefusedError(
                f"{self._link.where}: no zero, the environment unit was switched {'off' if self._corrects else 'on'} "
                "since the connection: switch it back, or connect again",
                0,
            )

    async def _require(self, method: str, *params: object) -> codec.Answer:
        answer = await self._ask(method, *params, repeat=Repeat.NEVER)
        if answer.error:
            raise await self._refused(method, answer.error)
        return answer

    async def _refused(self, method: str, number: int) -> RefusedError:
        text = (await self._ask("com.attocube.system.errorNumberToString", 1, number)).text()
        return RefusedError(f"{self._link.where}: {method} gave error {number}: {text}", number)

    async def _ask(self, method: str, *params: object, repeat: Repeat = Repeat.HARMLESS) -> codec.Answer:
        self._number += 1
        data = codec.encode(self._full(method), params, self._number, self._settings.dialect)
        decoder = partial(codec.AnswerDecoder, self._number)
        return await self._link.request(data, decoder, self._settings.timeout_s, repeat=repeat)

    def _full(self, method: str) -> str:
        if method.startswith("com."):
            return method
        space = "com.attocube." if method.startswith("ecu.") else f"com.attocube.{self._settings.dialect}."
        return space + method

    async def _greet(self) -> None:
        """Ask who is there."""
        self._latches.greeting()
        try:
            kind = (await self._exchange("system.getDeviceType")).text()
            firmware = (await self._exchange("com.attocube.system.getFirmwareVersion")).text()
        except (ProtocolError, LinkTimeoutError) as exc:
            raise self._stranger(exc) from None
        if self._type not in {"", kind}:
            raise WrongDeviceError(
                f"{self._link.where}: after the link was opened again {kind!r} answers instead of {self._type!r}: "
                "check the network"
            )
        self._type, self._firmware = kind, firmware
        self._latches.greeted()

    async def _recognise(self) -> None:
        """Check on the open link that the next answer belongs to the next question: the count goes on."""
        if (await self._exchange("system.getDeviceType")).text() != self._type:
            raise ProtocolError(f"{self._link.where}: the instrument does not report its type")

    async def _exchange(self, method: str) -> codec.Answer:
        self._number += 1
        data = codec.encode(self._full(method), (), self._number, self._settings.dialect)
        return await self._link.exchange(data, codec.AnswerDecoder(self._number), self._settings.timeout_s)

    def _stranger(self, cause: LinkError | ProtocolError) -> Exception:
        if self._type or not self._link.last_bytes:
            return cause
        return WrongDeviceError(
            f"{self._link.where}: what answers here is not an attocube IDS that knows com.attocube."
            f"{self._settings.dialect}: check host, port 9090 and the setting dialect; {cause}"
        )
