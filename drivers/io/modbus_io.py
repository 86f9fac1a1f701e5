"""A block of remote inputs and outputs over Modbus: a door contact and a stack light."""

from typing import Any, ClassVar, Literal, Protocol, Self

from pydantic import Field, model_validator

from catseye.drivers.links.driver import DeviceSettings
from catseye.drivers.links.endpoint import SerialEndpoint, require_stream
from catseye.drivers.modbus.client import ModbusDevice, RegisterClient, connected
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity, Sink
from catseye.drivers.roles.errors import LinkError, ProtocolError
from catseye.drivers.roles.io import Io, Light

_MOST_ON_A_LINE_S = 0.07
"""The door's silence lasts 0.24 s from a question on. On a line the question, what may come late, and the question
asked again each have this time, and opening the port again what is left."""

_FUNCTIONS = {"coil": 1, "input": 2}


class IoSettings(DeviceSettings):
    """What a cell file may set of a block. The addresses have no standard: the defaults just count from 0."""

    device_id: int = Field(default=1, ge=0, le=255, description="unit identifier.")
    door_input: int = Field(default=0, ge=0, le=0xFFFF, description="address of the door's contact.")
    door_kind: Literal["input", "coil"] = Field(
        default="input", description="`input` is read by function 2, `coil` by function 1."
    )
    door_closed: bool = Field(default=True, description="what the contact reads while the door is closed.")
    green_coil: int | None = Field(
        default=0,
        ge=0,
        le=0xFFFF,
        description="output of the green light; None without one, as for the others.",
    )
    amber_coil: int | None = Field(default=1, ge=0, le=0xFFFF, description="output of the amber light.")
    red_coil: int | None = Field(default=2, ge=0, le=0xFFFF, description="output of the red light.")
    address_base: Literal[0, 1] = Field(
        default=0, description="number that the documents give to the first address."
    )
    timeout_s: float = Field(default=1.0, gt=0, description="for connecting, real s.")
    answer_timeout_s: float = Field(
        default=0.1,
        gt=0,
        le=0.1,
        description="for an answer, real s: so short that a door whose answer is lost is asked again before its "
        "silence counts as open. On a serial line no more than 0.07 s count, since a late answer is "
        "waited for too.",
    )

    @model_validator(mode="after")
    def _apart(self) -> Self:
        coils = list(self.lights().values())
        if len(set(coils)) < len(coils):
            raise ValueError("two lights have the same coil; give each one its own")
        if min([self.door_input, *coils]) < self.address_base:
            raise ValueError("address 0 lies before address_base = 1: use 1 or more, or address_base = 0")
        return self

    def lights(self) -> dict[Light, int]:
        """Return the coils of the lights that there are."""
        named: dict[Light, int | None] = {
            "green": self.green_coil,
            "amber": self.amber_coil,
            "red": self.red_coil,
        }
        return {light: coil for light, coil in named.items() if coil is not None}


class Bits(ModbusDevice, Protocol):
    """Coils and inputs of one device."""

    async def read_bits(self, function: int, address: int, count: int) -> list[bool]:
        """Return coils or inputs."""
        ...

    async def write_bits(self, address: int, bits: list[bool]) -> None:
        """Set coils."""
        ...


class ModbusIo(Io):
    """Driver of a block of inputs and outputs."""

    Settings: ClassVar[type[IoSettings]] = IoSettings
    summary: ClassVar[str] = "Modbus TCP or RTU: door contact and stack light"

    def __init__(self, bits: Bits, settings: IoSettings) -> None:
        self._bits = bits
        self._settings = settings

    @classmethod
    def at(cls, endpoint: str, clock: Clock, sink: Sink | None = None, **settings: Any) -> Self:
        """Return a driver for an endpoint as the cell file writes it; nothing is opened yet.

        Args:
            endpoint: of the block, tcp:// or serial://.
            settings: fields of `IoSettings`.

        Raises:
            LinkError: the endpoint is wrong.
            pydantic.ValidationError: a setting is unknown or wrong.
        """
        del clock
        checked = IoSettings(**settings)
        target = require_stream(endpoint)
        most_s = _MOST_ON_A_LINE_S if isinstance(target, SerialEndpoint) else checked.answer_timeout_s
        client = RegisterClient(
            target,
            device_id=checked.device_id,
            name="remote I/O",
            timeout_s=checked.timeout_s,
            answer_timeout_s=min(checked.answer_timeout_s, most_s),
            sink=sink,
        )
        return cls(client, checked)

    async def connect(self) -> Identity:
        """Open the link, ask who is there and for the door, which a stranger does not know.

        Raises:
            WrongDeviceError: something answers that is no Modbus.
            RefusedError: the door's contact is not there.
            LinkError: unreachable or silent.
        """
        return await connected(self._bits, self._look_first, "Modbus remote I/O")

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        await self._bits.close()

    async def door_closed(self) -> bool:
        """Return whether the door is closed now.

        Raises:
            DeviceError: the block does not answer; the door then counts as open.
        """
        settings = self._settings
        address = settings.door_input - settings.address_base
        (bit,) = await self._bits.read_bits(_FUNCTIONS[settings.door_kind], address, 1)
        return bit is settings.door_closed

    async def show(self, light: Light) -> None:
        """Light one lamp and put the others out.

        Raises:
            DeviceError: the block does not take it.
        """
        for name, coil in self._settings.lights().items():
            await self._bits.write_bits(coil - self._settings.address_base, [name == light])

    async def _look_first(self) -> None:
        """Ask for the door, and once more when the answer is lost: afterwards whoever watches it does so."""
        try:
            await self.door_closed()
        except (LinkError, ProtocolError):
            await self.door_closed()
