"""Emulated Modbus devices from their options: which registers, and over which kind of link."""

from typing import Any, Literal

from pydantic import Field

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import DeviceOptions, Emulator, NewSession, Note
from catseye.simulators.errors import EmulatorError
from catseye.simulators.modbus.air_sensor import AirSensor
from catseye.simulators.modbus.point_sensor import PointSensor, comet_points, read_points
from catseye.simulators.modbus.remote_io import COUNT, RemoteIo
from catseye.simulators.modbus.rtu import SHORTEST_SILENCE_S, RtuSession
from catseye.simulators.modbus.tcp import ModbusSession, Registers
from catseye.simulators.ports.address import LineAddress, parse_address
from catseye.simulators.world.air_probe import AirProbe
from catseye.simulators.world.door import Door

_SILENT_CHARACTERS = 3.5
_COMET_CLIENTS = 2
_COMET_SERIAL = {0x1035: 0x0000, 0x1036: 0x0001, 0x1037: 0x0000}


class ModbusOptions(DeviceOptions):
    """Options of all Modbus devices.

    Attributes:
        device_id: address on a serial line.
        address_base: number that the documents give to the first register; None: as the map has it.
    """

    device_id: int = 1
    address_base: int | None = None


class AirOptions(ModbusOptions):
    """Options of an air sensor.

    Attributes:
        map: which register map.
        pressure_address: PDU address of the pressure in Vaisala's map.
        error_bit: of Vaisala's 32 error bits, the one that a sensor without values sets; no source says which.
        diagnostics: all functions of Vaisala's large transmitters, 07, 08 and 22 among them, which HMP probes and
            HMW90 do not have.
        points: registers of the map "generic", one table each.
        word_order: of the map "generic".
    """

    map: Literal["vaisala", "comet_web", "comet_rtu", "generic"] = "vaisala"
    pressure_address: int = 0x2C
    error_bit: int = Field(default=0, ge=0, le=31)
    diagnostics: bool = True
    points: list[dict[str, Any]] = Field(default_factory=list)
    word_order: Literal["big", "little"] = "big"


class IoOptions(ModbusOptions):
    """Options of a block of inputs and outputs.

    Attributes:
        door_input: address of the door's contact.
        door_kind: where the contact stands.
        door_closed: what it reads while the door is closed.
    """

    door_input: int = 0
    door_kind: Literal["input", "coil"] = "input"
    door_closed: bool = True


def air_registers(probe: AirProbe, device: EmulatedDevice) -> Registers:
    """Return the registers of an air sensor.

    Raises:
        EmulatorError: an option is wrong.
    """
    options = AirOptions.of(device)
    if options.map == "vaisala":
        return AirSensor(
            probe,
            options.pressure_address,
            error_bit=options.error_bit,
            diagnostics=options.diagnostics,
        )
    base = options.address_base
    if base is None:
        base = 1 if options.map == "comet_rtu" else 0
    if options.map == "generic":
        points = read_points(device.name, options.points, base)
        little = options.word_order == "little"
        return PointSensor(probe, "air sensor, register map of the cell file", points, little=little)
    serial = {address - base: word for address, word in _COMET_SERIAL.items()}
    return PointSensor(probe, "air sensor, Comet register map", comet_points(base), fixed=serial)


def io_block(door: Door, device: EmulatedDevice, coils: list[bool]) -> RemoteIo:
    """Return a block of inputs and outputs.

    Args:
        coils: outputs, one for each address; the block sets them.

    Raises:
        EmulatorError: an option is wrong.
    """
    options = IoOptions.of(device)
    address = options.door_input - (options.address_base or 0)
    if not 0 <= address < COUNT:
        raise EmulatorError(f"{device.name}: option door_input: the block has {COUNT} inputs")
    return RemoteIo(
        door,
        coils,
        address,
        door_is_coil=options.door_kind == "coil",
        closed_reads=options.door_closed,
    )


class ModbusAir(Emulator):
    """An air sensor."""

    role = "environment"
    Options = AirOptions

    @classmethod
    def most_clients(cls, device: EmulatedDevice) -> int | None:
        """Return what the option says; without it a Web Sensor has two (manual of the Tx6xx, Modbus TCP)."""
        if "clients" not in device.options and AirOptions.of(device).map == "comet_web":
            return _COMET_CLIENTS
        return super().most_clients(device)

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make the registers of the sensor."""
        return _served(air_registers(context.air.of(device.name), device), device, note)


class ModbusIo(Emulator):
    """A block of inputs and outputs with the contact of the door."""

    role = "io"
    Options = IoOptions

    @classmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make the registers of the block."""
        coils = context.coils.setdefault(device.name, [False] * COUNT)
        return _served(io_block(context.door, device, coils), device, note)


def _served(registers: Registers, device: EmulatedDevice, note: Note) -> NewSession:
    """Speak RTU on a serial line, TCP elsewhere."""
    address = parse_address(device.name, device.endpoint)
    if not isinstance(address, LineAddress):
        return lambda: ModbusSession(registers, note)
    unit = ModbusOptions.of(device).device_id
    silence_s = max(SHORTEST_SILENCE_S, _SILENT_CHARACTERS * address.byte_s)
    return lambda: RtuSession(registers, unit, note, silence_s)
