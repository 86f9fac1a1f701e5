"""modbus-tk."""

from typing import Any

import serial
from modbus_tk import defines, modbus_rtu, modbus_tcp

Calls = dict[str, Any]


def tcp(port: int) -> Calls:
    """Return its calls over TCP."""
    return _calls(modbus_tcp.TcpMaster("127.0.0.1", port, timeout_in_sec=5.0), 1)


def rtu(line: str, baud: int, parity: str, unit: int) -> Calls:
    """Return its calls over a serial line."""
    master = modbus_rtu.RtuMaster(serial.Serial(line, baud, parity=parity))
    master.set_timeout(1.0)
    return _calls(master, unit)


def _calls(master: Any, unit: int) -> Calls:
    def reading(function: int) -> Any:
        return lambda address, count: master.execute(unit, function, address, count)

    def writing(function: int) -> Any:
        return lambda address, value: master.execute(unit, function, address, output_value=value)

    return {
        "holding": reading(defines.READ_HOLDING_REGISTERS),
        "input": reading(defines.READ_INPUT_REGISTERS),
        "coils": reading(defines.READ_COILS),
        "discrete": reading(defines.READ_DISCRETE_INPUTS),
        "write_register": writing(defines.WRITE_SINGLE_REGISTER),
        "write_registers": writing(defines.WRITE_MULTIPLE_REGISTERS),
        "write_coil": writing(defines.WRITE_SINGLE_COIL),
        "write_coils": writing(defines.WRITE_MULTIPLE_COILS),
    }
