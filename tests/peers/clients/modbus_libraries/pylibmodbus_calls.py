"""pylibmodbus: libmodbus from Python."""

from typing import Any

from pylibmodbus import ModbusRtu, ModbusTcp

Calls = dict[str, Any]


def tcp(port: int) -> Calls:
    """Return its calls over TCP."""
    return _calls(ModbusTcp("127.0.0.1", port), 1)


def rtu(line: str, baud: int, parity: str, unit: int) -> Calls:
    """Return its calls over a serial line."""
    return _calls(ModbusRtu(line.encode(), baud, parity.encode(), 8, 1), unit)


def _calls(client: Any, unit: int) -> Calls:
    client.set_slave(unit)
    client.connect()
    return {
        "holding": client.read_registers,
        "input": client.read_input_registers,
        "coils": client.read_bits,
        "discrete": client.read_input_bits,
        "write_register": client.write_register,
        "write_registers": client.write_registers,
        "write_coil": client.write_bit,
        "write_coils": lambda a, v: client.write_bits(a, len(v), v),
    }
