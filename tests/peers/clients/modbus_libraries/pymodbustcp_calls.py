"""pyModbusTCP."""

from typing import Any

from pyModbusTCP.client import ModbusClient

Calls = dict[str, Any]


def tcp(port: int) -> Calls:
    """Return its calls over TCP."""
    client = ModbusClient("127.0.0.1", port=port, unit_id=1, timeout=5.0)

    def good(answer: Any) -> Any:
        if not answer:
            raise ValueError(client.last_except_as_txt)
        return answer

    return {
        "holding": lambda a, n: good(client.read_holding_registers(a, n)),
        "input": lambda a, n: good(client.read_input_registers(a, n)),
        "coils": lambda a, n: good(client.read_coils(a, n)),
        "discrete": lambda a, n: good(client.read_discrete_inputs(a, n)),
        "write_register": lambda a, v: good(client.write_single_register(a, v)),
        "write_registers": lambda a, v: good(client.write_multiple_registers(a, v)),
        "write_coil": lambda a, v: good(client.write_single_coil(a, v)),
        "write_coils": lambda a, v: good(client.write_multiple_coils(a, v)),
    }
