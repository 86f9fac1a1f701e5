"""modbuslink."""

from typing import Any

from modbuslink import SyncModbusClient, SyncRtuTransport, SyncTcpTransport

from modbus_libraries.standard_names import Calls, by_standard_names


def tcp(port: int) -> Calls:
    """Return its calls over TCP."""
    return _calls(SyncTcpTransport(host="127.0.0.1", port=port, timeout=5.0), 1)


def rtu(line: str, baud: int, parity: str, unit: int) -> Calls:
    """Return its calls over a serial line."""
    return _calls(SyncRtuTransport(line, baudrate=baud, parity=parity), unit)


def _calls(transport: Any, unit: int) -> Calls:
    client = SyncModbusClient(transport)
    transport.open()

    def call(name: str) -> Any:
        return lambda address, value: getattr(client, name)(unit, address, value)

    return by_standard_names(call)
