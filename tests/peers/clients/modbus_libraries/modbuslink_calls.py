"""modbuslink."""

from typing import Any

from modbuslink import SyncModbusClient, SyncRtuTransport, SyncTcpTransport

Calls = dict[str, Any]


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

    return {
        "holding": call("read_holding_registers"),
        "input": call("read_input_registers"),
        "coils": call("read_coils"),
        "discrete": call("read_discrete_inputs"),
        "write_register": call("write_single_register"),
        "write_registers": call("write_multiple_registers"),
        "write_coil": call("write_single_coil"),
        "write_coils": call("write_multiple_coils"),
    }
