"""An air sensor over Modbus TCP or RTU."""

from typing import Any, ClassVar, Protocol, Self

from catseye.drivers.air.maps import (
    VAISALA_PRESSURE_NOTE,
    AirSettings,
    Name,
    RegisterMap,
    check_plausible,
    decode,
    resolve,
)
from catseye.drivers.links.endpoint import require_stream
from catseye.drivers.modbus.client import ModbusDevice, RegisterClient, connected
from catseye.drivers.roles.air import AirSample, AirSensor
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity, Sink
from catseye.drivers.roles.errors import ProtocolError, RefusedError

_BLOCK_REGISTERS = 64
_ILLEGAL_ADDRESS = 2


class Registers(ModbusDevice, Protocol):
    """Reads registers of one sensor."""

    @property
    def endpoint(self) -> str:
        """Where it leads."""
        ...

    async def read(self, function: int, address: int, count: int) -> list[int]:
        """Return registers."""
        ...


class ModbusAir(AirSensor):
    """Air sensor driver."""

    Settings: ClassVar[type[AirSettings]] = AirSettings
    summary: ClassVar[str] = "Modbus TCP or RTU: Vaisala, Comet, or registers of your own"

    def __init__(self, registers: Registers, clock: Clock, register_map: RegisterMap) -> None:
        self._registers = registers
        self._clock = clock
        self._map = register_map
        self._in_one_block = True

    @classmethod
    def at(cls, endpoint: str, clock: Clock, sink: Sink | None = None, **settings: Any) -> Self:
        """Return a driver for an endpoint as the cell file writes it; nothing is opened yet.

        Args:
            endpoint: where it answers, tcp:// or serial://, as in a cell file.
            settings: fields of `AirSettings`.

        Raises:
            LinkError: the endpoint is wrong.
            ProfileError: the settings leave no quantity.
            pydantic.ValidationError: a setting is unknown or wrong.
        """
        checked = AirSettings(**settings)
        target = require_stream(endpoint)
        client = RegisterClient(target, device_id=checked.device_id, timeout_s=checked.timeout_s, sink=sink)
        return cls(client, clock, resolve(checked))

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know about this sensor; empty when all is as it should be."""
        missing = [
            name for name in ("temperature", "pressure", "humidity") if name not in self._map.quantities()
        ]
        if missing == ["pressure"] and self._map.title.startswith("Vaisala"):
            return (VAISALA_PRESSURE_NOTE,)
        return (f"not measured: {', '.join(missing)}",) if missing else ()

    async def connect(self) -> Identity:
        """Open the link, ask who is there and for one sample, which a stranger cannot give.

        Raises:
            WrongDeviceError: something answers that is no Modbus.
            RefusedError: the registers are not there.
            ProtocolError: values that no air has.
            LinkError: unreachable or silent.
        """
        return await connected(self._registers, self.sample, self._map.title)

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        await self._registers.close()

    async def sample(self) -> AirSample:
        """Return the state of the air now.

        Over TCP no check sum of the protocol guards requests and values: an exception, and values that no air has,
        are believed when they come twice.

        Raises:
            RefusedError: the sensor answers with an exception.
            ProtocolError: values that no air has.
            LinkError: lost or silent.
        """
        try:
            return await self._sampled()
        except (RefusedError, ProtocolError):
            return await self._sampled()

    async def _sampled(self) -> AirSample:
        values = await self._read()
        time_s = self._clock.monotonic_s()
        for name, value in values.items():
            try:
                check_plausible(name, value, self._map)
            except ProtocolError as exc:
                raise ProtocolError(f"air sensor at {self._registers.endpoint}: {exc}") from None
        return AirSample(values.get("temperature"), values.get("pressure"), values.get("humidity"), time_s)

    async def _read(self) -> dict[Name, float | None]:
        """Read all quantities at once if they lie near enough together and the sensor lets one read across."""
        quantities = self._map.quantities().values()
        first = min(self._map.wire_address(q) for q in quantities)
        count = max(self._map.wire_address(q) + q.registers for q in quantities) - first
        if self._in_one_block and count <= _BLOCK_REGISTERS:
            try:
                return self._decode(first, await self._registers.read(self._map.function, first, count))
            except RefusedError as exc:
                if exc.number != _ILLEGAL_ADDRESS or len(quantities) == 1:
                    raise
                self._in_one_block = False
        values: dict[Name, float | None] = {}
        for name, quantity in self._map.quantities().items():
            address = self._map.wire_address(quantity)
            words = await self._registers.read(self._map.function, address, quantity.registers)
            values[name] = decode(words, quantity, self._map.word_order)
        return values

    def _decode(self, first: int, words: list[int]) -> dict[Name, float | None]:
        """Return the quantities in a block of registers that begins at `first`."""
        values: dict[Name, float | None] = {}
        for name, quantity in self._map.quantities().items():
            start = self._map.wire_address(quantity) - first
            values[name] = decode(words[start : start + quantity.registers], quantity, self._map.word_order)
        return values
