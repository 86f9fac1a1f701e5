"""libmodbuspy, registers only: for coils and inputs it returns nothing.

Its class ModbusClient lacks an attribute of its base and fails at the first call; the ports below it work.
"""

import struct
from typing import Any

from libmodbuspy import Parity, ProtocolType
from libmodbuspy.utils import createClientPort

Calls = dict[str, Any]


def tcp(port: int) -> Calls:
    """Return its calls over TCP."""
    return _calls(createClientPort(ProtocolType.TCP, True, host="127.0.0.1", port=port, timeout=5000), 1)


def rtu(line: str, baud: int, parity: str, unit: int) -> Calls:
    """Return its calls over a serial line."""
    settings = {
        "portName": line,
        "baudRate": baud,
        "parity": {"E": Parity.EvenParity, "N": Parity.NoParity}[parity],
    }
    return _calls(createClientPort(ProtocolType.RTU, True, **settings), unit)


def _calls(port: Any, unit: int) -> Calls:
    def words(given: bytes, count: int) -> tuple[int, ...]:
        return struct.unpack(f"<{count}H", given)

    return {
        "holding": lambda a, n: words(port.readHoldingRegisters(unit, a, n), n),
        "input": lambda a, n: words(port.readInputRegisters(unit, a, n), n),
        "write_register": lambda a, v: port.writeSingleRegister(unit, a, v),
        "write_registers": lambda a, v: port.writeMultipleRegisters(unit, a, struct.pack(f"<{len(v)}H", *v)),
    }
