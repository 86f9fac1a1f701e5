"""minimalmodbus: serial lines only."""

from typing import Any

import minimalmodbus

Calls = dict[str, Any]


def rtu(line: str, baud: int, parity: str, unit: int) -> Calls:
    """Return its calls over a serial line."""
    client = minimalmodbus.Instrument(line, unit)
    client.serial.baudrate, client.serial.parity, client.serial.timeout = baud, parity, 1.0
    return {
        "holding": client.read_registers,
        "input": lambda a, n: client.read_registers(a, n, functioncode=4),
        "coils": lambda a, n: client.read_bits(a, n, functioncode=1),
        "discrete": lambda a, n: client.read_bits(a, n, functioncode=2),
        "write_register": lambda a, v: client.write_register(a, v, functioncode=6),
        "write_registers": client.write_registers,
        "write_coil": lambda a, v: client.write_bit(a, int(v), functioncode=5),
        "write_coils": lambda a, v: client.write_bits(a, [int(bit) for bit in v]),
    }
