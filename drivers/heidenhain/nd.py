"""Heidenhain ND 28x: a position display that shows the count of an interferometer."""

from typing import ClassVar, Literal

from pydantic import Field

from catseye.drivers.heidenhain import codec
from catseye.drivers.links.driver import DeviceSettings, LinkDriver
from catseye.drivers.links.healing import Repeat
from catseye.drivers.links.latches import Latches
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import LinkTimeoutError, ProtocolError, RefusedError, WrongDeviceError
from catseye.drivers.roles.interferometer import BeamStatus, Compensated, Interferometer, LengthReading

MODEL = "Heidenhain ND"

_CLEAR = "T0100"
_ZERO_KEYS = ("T0000", "T0104")


class NdSettings(DeviceSettings):
    """What a cell file may set. Times are real seconds."""

    decimals: int = Field(
        default=4,
        ge=0,
        le=7,
        description="digits behind the decimal point, which a position is sent without; compared with the display at "
        "each connection and each zero.",
    )
    sign: Literal[1, -1] = Field(
        default=1, description="-1 when the display falls while the beam grows longer."
    )
    compensated: Literal["none", "instrument"] = Field(
        default="none",
        description="`instrument` when the display shows lengths that are corrected for the air.",
    )
    zero: Literal["software", "keys"] = Field(
        default="software",
        description="`software` keeps an offset in this program, `keys` presses 0 and ENT, which sets the datum.",
    )
    error_request: Literal["A0301", "A0300"] = Field(
        default="A0301", description="asks for the error text: A0301 with an ND 287, A0300 with older units."
    )
    timeout_s: float = Field(default=1.0, gt=0, description="for an answer.")
    connect_timeout_s: float = Field(default=5.0, gt=0, description="for connecting.")
    quiet_s: float = Field(default=0.05, gt=0, description="silence after which a link counts as drained.")


class HeidenhainNd(LinkDriver, Interferometer):
    """Interferometer driver. The display gives no signal level: it is 1 without and 0 with an error.

    Args:
        transport: the connection; the display's line has 9600 baud, 7 bits, even parity, 2 stop bits.
    """

    Settings: ClassVar[type[NdSettings]] = NdSettings
    summary: ClassVar[str] = "display HEIDENHAIN ND 287 and older, serial"

    def __init__(self, transport: Transport, clock: Clock, settings: NdSettings | None = None) -> None:
        self._settings = settings or NdSettings()
        self._clock = clock
        self._latches = Latches()
        self._offset_mm = 0.0
        self._identity: tuple[str, str, str] | None = None
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
        return ("the display reports no signal level: it is shown as 1 with and 0 without a signal",)

    @property
    def compensated(self) -> Compensated:
        """Whether the lengths are corrected for the air before they come here."""
        return self._settings.compensated

    @property
    def count_mm(self) -> float:
        """Displacement that 1 in the instrument's number means, by the settings, mm."""
        return self._settings.sign * 10.0**-self._settings.decimals

    async def connect(self) -> Identity:
        """Open the link and check who answers.

        Raises:
            WrongDeviceError: something else answers, or the display's decimals are not those of the settings.
            LinkError: unreachable or silent.
        """
        self._identity = None
        await self._link.open()
        return self._described()

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        await self._link.close()

    async def zero(self) -> int:
        """Zero the count, clear the error on the display; return the new zero's number.

        The arm stands still meanwhile: when a key's answer is lost all are pressed again, and the last zero counts.

        Raises:
            RefusedError: the error does not go away, or the display refuses a key.
            WrongDeviceError: the display's decimals are not those of the settings.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        if text := await self._error_that_stays():
            raise RefusedError(
                f"{self._link.where}: no zero, the display shows {text!r}: aim the beam first", 0
            )
        # A display that was connected without a signal had no value to compare with.
        self._check_decimals(await self._ask("A0100"))
        if self._settings.zero == "keys":
            await self._link.repeated(self._press_zero)
            self._offset_mm = 0.0
        else:
            self._offset_mm = (await self._position())[0]
        return self._latches.zeroed()

    async def read(self) -> LengthReading:
        """Return one reading.

        Raises:
            RefusedError: the display refuses.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        position_mm, raw = await self._position()
        time_s = self._clock.monotonic_s()
        return LengthReading(position_mm - self._offset_mm, raw, time_s, self._latches.zero_id)

    async def status(self) -> BeamStatus:
        """Return the state of the beam: no error on the display. An old error is cleared and looked at again.

        Raises:
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        text = await self._error_that_stays()
        return BeamStatus(
            beam_ok=not text,
            beam_lost=self._latches.beam_lost,
            overspeed=self._latches.overspeed,
            laser_ready=True,
            signal=0.0 if text else 1.0,
            signal_native=text,
            zero_id=self._latches.zero_id,
        )

    def _described(self) -> Identity:
        model, software, version = self._identity or (MODEL, "", "")
        return Identity(model, f"{software} {version}".strip(), "", "EMULATOR" in software.upper())

    async def _position(self) -> tuple[float, str]:
        """Return the position, growing with the beam, mm, and its text."""
        return await self._link.repeated(self._parsed_position)

    async def _parsed_position(self) -> tuple[float, str]:
        text = await self._ask("A0200", Repeat.NEVER)
        try:
            value_mm = codec.parse_position(text, self._settings.decimals)
        except ProtocolError as exc:
            raise self._garbage("A0200", exc) from None
        return self._settings.sign * value_mm, text

    async def _error_text(self) -> str:
        text = await self._shown_error()
        self._latches.note(beam_lost=bool(text))
        return text

    async def _shown_error(self) -> str:
        """Return the error on the display; a unit may refuse the question for its text while there is none."""
        try:
            return await self._ask(self._settings.error_request)
        except RefusedError:
            shown = await self._ask("A0100")
            return "" if codec.displayed_decimals(shown) is not None else shown

    async def _error_that_stays(self) -> str:
        """Clear the error on the display, if there is one; return what is shown then."""
        return await self._link.repeated(self._cleared)

    async def _cleared(self) -> str:
        # Looked at before each press: what C does without an error depends on the display's parameters.
        if not await self._error_text():
            return ""
        await self._press(_CLEAR)
        return await self._error_text()

    async def _press_zero(self) -> None:
        """Set the datum to 0; from its beginning always, since only zeros are ever entered: 00 ENT sets 0 too."""
        with self._latches.zeroing():
            for key in _ZERO_KEYS:
                await self._press(key)

    async def _press(self, key: str) -> None:
        reply = await self._ask(key, Repeat.NEVER)
        if reply != codec.ACK:
            raise self._garbage(key, ProtocolError(f"{reply[:32]!r} instead of an acknowledgement"))

    async def _ask(self, command: str, repeat: Repeat = Repeat.HARMLESS) -> str:
        data = codec.command(command)
        reply = await self._link.request(data, codec.ReplyDecoder, self._settings.timeout_s, repeat=repeat)
        if reply == (codec.NAK,):
            raise RefusedError(
                f"{self._link.where} refused {command}: look at the display, and whether its keys are locked",
                0,
            )
        return reply[0]

    def _garbage(self, command: str, cause: ProtocolError) -> ProtocolError:
        self._link.distrust(f"{command} had an answer that does not fit")
        return ProtocolError(f"{self._link.where}: {command}: {cause}: check the line's settings")

    async def _greet(self) -> None:
        """Ask who is there, and whether the display's unit and decimals are those of the settings."""
        self._latches.greeting()
        try:
            identity = await self._exchange("A0000", lines=3)
            bar = codec.parse_indicators((await self._exchange("A0900"))[0])
            shown = await self._exchange("A0100")
        except (ProtocolError, LinkTimeoutError) as exc:
            if self._identity or not self._link.last_bytes:
                raise
            raise WrongDeviceError(
                f"{self._link.where}: what answers here is not a {MODEL} display: check the port and its 7E2; {exc}"
            ) from None
        if len(identity) != 3 or self._identity not in {None, identity}:
            raise WrongDeviceError(
                f"{self._link.where}: {identity!r} answers instead of {self._identity or MODEL!r}: check the port"
            )
        if bar["INCH"]:
            raise WrongDeviceError(f"{self._link.where}: the display shows inches: switch it to millimetres")
        self._check_decimals(shown[0])
        self._identity = (identity[0], identity[1], identity[2])
        self._latches.greeted()

    async def _recognise(self) -> None:
        """Check on the open line that the next answer belongs to the next question: the count goes on."""
        if await self._exchange("A0000", lines=3) != self._identity:
            raise ProtocolError(f"{self._link.where}: the display does not report its name")

    def _check_decimals(self, shown: str) -> None:
        """Compare with the displayed value; with an error on the display there is none."""
        decimals = codec.displayed_decimals(shown)
        if decimals not in {None, self._settings.decimals}:
            raise WrongDeviceError(
                f"{self._link.where}: the display shows {shown!r}, the cell file says decimals = "
                f"{self._settings.decimals}: set decimals = {decimals}"
            )

    async def _exchange(self, command: str, lines: int = 1) -> tuple[str, ...]:
        data = codec.command(command)
        return await self._link.exchange(data, codec.ReplyDecoder(lines), self._settings.timeout_s)
