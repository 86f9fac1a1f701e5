"""modbus-rs: a core in Rust."""

from typing import Any

import modbus_rs

Calls = dict[str, Any]


def tcp(port: int) -> Calls:
    """Return its calls over TCP."""
    return _calls(modbus_rs.TcpTransport.connect("127.0.0.1", port=port), 1)


def rtu(line: str, baud: int, parity: str, unit: int) -> Calls:
    """Return its calls over a serial line."""
    names = {"E": "even", "N": "none"}
    return _calls(modbus_rs.RtuTransport.open(line, baud_rate=baud, parity=names[parity]), unit)


def _calls(transport: Any, unit: int) -> Calls:
    client = transport.create_client(unit_id=unit)
    state = modbus_rs.CoilState
    return {
        "holding": client.read_holding_registers,
        "input": client.read_input_registers,
        "coils": client.read_coils,
        "discrete": client.read_discrete_inputs,
        "write_register": client.write_register,
        "write_registers": client.write_registers,
        "write_coil": lambda a, v: client.write_coil(a, state.On if v else state.Off),
        "write_coils": lambda a, v: client.write_coils(a, [state.On if bit else state.Off for bit in v]),
    }
