"""EasyModbus; its documented module `modbusClient` cannot be imported: it misses `modbus_client`.

Its serial client cannot connect: it opens a TCP socket as well.
"""

from typing import Any

from easymodbus.modbus_client import ModbusClient

Calls = dict[str, Any]


def tcp(port: int) -> Calls:
    """Return its calls over TCP."""
    return _calls(ModbusClient("127.0.0.1", port))


def _calls(client: Any) -> Calls:
    client.connect()
    return {
        "holding": client.read_holdingregisters,
        "input": client.read_inputregisters,
        "coils": client.read_coils,
        "discrete": client.read_discreteinputs,
        "write_register": client.write_single_register,
        "write_registers": client.write_multiple_registers,
        "write_coil": client.write_single_coil,
        "write_coils": client.write_multiple_coils,
    }
