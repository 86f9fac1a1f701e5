"""Driver of the LD5."""

from collections.abc import Callable
from typing import ClassVar, TypeVar

from pydantic import Field

from catseye.drivers.links.driver import DeviceSettings, LinkDriver
from catseye.drivers.links.healing import Repeat
from catseye.drivers.links.latches import Latches
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import ProtocolError, RefusedError, WrongDeviceError
from catseye.drivers.roles.interferometer import BeamStatus, Compensated, Interferometer, LengthReading
from norra_ld5 import codec

T = TypeVar("T")


class Ld5Settings(DeviceSettings):
    """What a cell file may set in `[interferometer.settings]`."""

    answer_timeout_s: float = Field(default=1.0, gt=0, description="for an answer.")
    connect_timeout_s: float = Field(default=5.0, gt=0, description="for connecting.")


class NorraLd5(LinkDriver, Interferometer):
    """Interferometer driver."""

    Settings: ClassVar[type[Ld5Settings]] = Ld5Settings
    summary: ClassVar[str] = "Norra LD5, text commands over TCP or serial"

    def __init__(self, transport: Transport, clock: Clock, settings: Ld5Settings) -> None:
        self._clock = clock
        self._settings = settings
        self._latches = Latches()
        self._name = ""
        self._link = RequestLink(transport, name="Norra LD5", greet=self._greet)

    @property
    def compensated(self) -> Compensated:
        """Who corrects the lengths for the air: the display."""
        return "instrument"

    async def connect(self) -> Identity:
        """Open the link and check who answers.

        Raises:
            WrongDeviceError: something else answers.
            LinkError: unreachable or silent.
        """
        self._name = ""
        await self._link.open()
        model, firmware, serial = self._name.split(",")
        return Identity(model, firmware, serial, simulated="EMULATOR" in model)

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        await self._link.close()

    async def zero(self) -> int:
        """Zero the count, clear the latched faults; return the new zero's number.

        Raises:
            RefusedError: no beam returns.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        # The arm stands still meanwhile: a zero whose answer is lost is sent again, and the last one counts.
        await self._link.repeated(self._zero)
        return self._latches.zeroed()

    async def read(self) -> LengthReading:
        """Return one reading.

        Raises:
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        value = await self._ask(codec.POSITION)
        time_s = self._clock.monotonic_s()
        return LengthReading(
            self._parsed(codec.parse_position_mm, value), value, time_s, self._latches.zero_id
        )

    async def status(self) -> BeamStatus:
        """Return the state of the beam.

        Raises:
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        status = self._parsed(codec.parse_status, await self._ask(codec.STATUS))
        self._latches.note(beam_lost=status.lost or not status.beam, overspeed=status.fast)
        return BeamStatus(
            beam_ok=status.beam,
            beam_lost=self._latches.beam_lost,
            overspeed=self._latches.overspeed,
            laser_ready=status.ready,
            signal=min(1.0, status.signal_percent / 100.0),
            signal_native=f"{status.signal_percent} %",
            zero_id=self._latches.zero_id,
        )

    async def _zero(self) -> None:
        with self._latches.zeroing():
            await self._ask(codec.ZERO, Repeat.NEVER)

    async def _ask(self, command: str, repeat: Repeat = Repeat.HARMLESS) -> str:
        """Return the value in the answer to a command."""
        data, timeout_s = codec.encode(command), self._settings.answer_timeout_s
        line = await self._link.request(data, codec.AnswerDecoder, timeout_s, repeat=repeat)
        if line.startswith("?"):
            raise RefusedError(
                f"{self._link.where} refused {command}: {line[1:]}: look the letter up in the manual, section 5",
                0,
            )
        return self._parsed(lambda text: codec.value_of(command, text), line)

    def _parsed(self, parse: Callable[[str], T], text: str) -> T:
        """Parse; after an answer that makes no sense the link is restored before the next request."""
        try:
            return parse(text)
        except ProtocolError as exc:
            self._link.distrust(str(exc))
            raise ProtocolError(f"{self._link.where}: {exc}: check that nothing else answers there") from None

    async def _greet(self) -> None:
        """Ask who is there, after each opening of the link."""
        self._latches.greeting()
        try:
            line = await self._link.exchange(
                codec.encode(codec.IDENTITY), codec.AnswerDecoder(), self._settings.answer_timeout_s
            )
            name = codec.value_of(codec.IDENTITY, line)
            if not name.startswith("NORRA LD5") or name.count(",") != 2 or self._name not in {"", name}:
                raise ProtocolError(f"{name[:64]!r} answers")
        except ProtocolError as exc:
            raise WrongDeviceError(
                f"{self._link.where}: this is not the Norra LD5 that was expected: {exc}: check host and port"
            ) from None
        self._name = name
        self._latches.greeted()
