"""Emulated Modbus devices from their options: which registers, and over which kind of link."""

from collections.abc import Callable

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.errors import EmulatorError
from catseye.simulators.modbus.air_sensor import AirSensor
from catseye.simulators.modbus.point_sensor import PointSensor, comet_points, read_points
from catseye.simulators.modbus.remote_io import COUNT, Door, RemoteIo
from catseye.simulators.modbus.rtu import SHORTEST_SILENCE_S, RtuSession
from catseye.simulators.modbus.tcp import ModbusSession, Registers
from catseye.simulators.options import choice, number
from catseye.simulators.ports.address import LineAddress, parse_address
from catseye.simulators.ports.session import Session
from catseye.simulators.world.air_probe import AirProbe

_MAPS = ("vaisala", "comet_web", "comet_rtu", "generic")
_SILENT_CHARACTERS = 3.5
_COMET_SERIAL = {0x1035: 0x0000, 0x1036: 0x0001, 0x1037: 0x0000}


def air_registers(probe: AirProbe, device: EmulatedDevice) -> Registers:
    """Return the registers of an air sensor.

    Raises:
        EmulatorError: an option is wrong.
    """
    kind = choice(device, "map", _MAPS)
    if kind == "vaisala":
        return AirSensor(probe, int(number(device, "pressure_address", 0x2C)))
    base = int(number(device, "address_base", 1 if kind == "comet_rtu" else 0))
    if kind == "generic":
        points = read_points(device.name, device.options.get("points"), base)
        little = choice(device, "word_order", ("big", "little")) == "little"
        return PointSensor(probe, "air sensor, register map of the cell file", points, little=little)
    serial = {address - base: word for address, word in _COMET_SERIAL.items()}
    return PointSensor(probe, "air sensor, Comet register map", comet_points(base), fixed=serial)


def io_block(door: Door, device: EmulatedDevice) -> RemoteIo:
    """Return a block of inputs and outputs.

    Raises:
        EmulatorError: an option is wrong.
    """
    address = int(number(device, "door_input", 0)) - int(number(device, "address_base", 0))
    if not 0 <= address < COUNT:
        raise EmulatorError(f"{device.name}: option door_input: the block has {COUNT} inputs")
    kind = choice(device, "door_kind", ("input", "coil"))
    closed_reads = device.options.get("door_closed", True) is True
    return RemoteIo(door, address, door_is_coil=kind == "coil", closed_reads=closed_reads)


def modbus_sessions(
    registers: Registers, device: EmulatedDevice, note: Callable[[str], None]
) -> Callable[[], Session]:
    """Return what makes sessions: RTU on a serial line, TCP elsewhere.

    Raises:
        EmulatorError: an option is wrong.
    """
    address = parse_address(device.name, device.endpoint)
    if not isinstance(address, LineAddress):
        return lambda: ModbusSession(registers, note)
    unit = int(number(device, "device_id", 1))
    silence_s = max(SHORTEST_SILENCE_S, _SILENT_CHARACTERS * address.byte_s)
    return lambda: RtuSession(registers, unit, note, silence_s)
