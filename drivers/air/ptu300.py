"""Vaisala's PTU300 family over its ASCII interface, on a serial line or a socket."""

from functools import partial
from typing import ClassVar

from pydantic import Field

from catseye.drivers.air.ptu300_codec import FORM, TextDecoder, checked, parse_values
from catseye.drivers.links.driver import DeviceSettings, LinkDriver
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.air import AirSample, AirSensor
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import LinkError, ProtocolError, WrongDeviceError

_HARMLESS = b"\r\n> "

_STOP = b"S\r"
"""Ends the continuous output of a sensor that was left in RUN."""


class PtuSettings(DeviceSettings):
    """What a cell file may set of a PTU300. Times are real seconds."""

    address: int | None = Field(
        default=None,
        ge=0,
        le=255,
        description="of the sensor on a line with several ones (mode POLL); it is opened by `OPEN`.",
    )
    timeout_s: float = Field(default=2.0, gt=0, description="for connecting and for an answer.")

    @property
    def connect_timeout_s(self) -> float:
        """How long connecting may take, real s."""
        return self.timeout_s


class VaisalaAscii(LinkDriver, AirSensor):
    """Air sensor driver.

    It sets an output format of its own, with a checksum. A sensor that refuses it is read in the format that it has,
    by the names and units in its line.
    """

    Settings: ClassVar[type[PtuSettings]] = PtuSettings
    summary: ClassVar[str] = "Vaisala PTU300, serial text commands"

    def __init__(self, transport: Transport, clock: Clock, settings: PtuSettings) -> None:
        self._clock = clock
        self._settings = settings
        # On a line with several sensors only OPEN reaches one.
        first = _STOP if settings.address is None else b""
        self._link = RequestLink(transport, name="PTU300", greet=self._greet, first=first, harmless=_HARMLESS)
        self._version = ""
        self._serial = ""
        self._own_format = False

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know about this sensor."""
        if self._own_format or not self._version:
            return ()
        return ("the sensor refuses the output format with a checksum: its lines are read as they come",)

    async def connect(self) -> Identity:
        """Open the link, ask who is there and for one sample.

        Raises:
            WrongDeviceError: something answers that is no PTU300.
            ProtocolError: its line cannot be read.
            LinkError: unreachable or silent.
        """
        self._version = self._serial = ""
        await self._link.open()
        try:
            await self.sample()
        except BaseException:
            await self._link.close()
            raise
        model, _, firmware = self._version.partition("/")
        return Identity(
            model=f"Vaisala {model.strip()}",
            firmware=firmware.strip(),
            serial=self._serial,
            simulated="EMULATOR" in self._version.upper(),
        )

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        await self._link.close()

    async def sample(self) -> AirSample:
        """Return the state of the air now.

        Raises:
            ProtocolError: the line cannot be read.
            LinkError: lost or silent.
        """
        return await self._link.repeated(self._sampled)

    async def _sampled(self) -> AirSample:
        line = await self._link.request(b"SEND\r", partial(TextDecoder, "SEND"), self._settings.timeout_s)
        time_s = self._clock.monotonic_s()
        try:
            values = parse_values(checked(line) if self._own_format else line)
        except ProtocolError as error:
            self._link.distrust("SEND had an answer that does not fit")
            raise ProtocolError(
                f"{self._link.where}: {error}: check the line's settings (4800 7E1 are usual) and the sensor's format"
            ) from None
        return AirSample(values.temperature_c, values.pressure_hpa, values.humidity_percent, time_s)

    async def _greet(self) -> None:
        """Ask who is there and set the output format."""
        if self._settings.address is not None:
            await self._ask(f"OPEN {self._settings.address}")
        version = await self._ask("VERS")
        serial = (await self._ask("SNUM")).rpartition(":")[2].strip()
        if "/" not in version:
            raise WrongDeviceError(
                f"{self._link.where}: VERS was answered by {version[:64]!r}: no PTU300; check the endpoint"
            )
        if self._serial and (version, serial) != (self._version, self._serial):
            raise WrongDeviceError(
                f"{self._link.where}: {version} {serial} answers instead of {self._version} {self._serial}: who "
                "changed the sensor? start again"
            )
        self._version, self._serial = version.strip(), serial
        self._own_format = (await self._ask(f"FORM {FORM}")).strip() == "OK"

    async def _ask(self, command: str) -> str:
        try:
            return await self._link.exchange(
                f"{command}\r".encode("ascii"), TextDecoder(command), self._settings.timeout_s
            )
        except LinkError as error:
            raise type(error)(f"{error}: check that the sensor is in the mode STOP or SEND") from None
