"""pymodbus."""

from typing import Any

from pymodbus.client import ModbusSerialClient, ModbusTcpClient

Calls = dict[str, Any]


def tcp(port: int) -> Calls:
    """Return its calls over TCP."""
    return _calls(ModbusTcpClient("127.0.0.1", port=port), 1)


def rtu(line: str, baud: int, parity: str, unit: int) -> Calls:
    """Return its calls over a serial line."""
    return _calls(ModbusSerialClient(line, baudrate=baud, parity=parity), unit)


def _calls(client: Any, unit: int) -> Calls:
    assert client.connect()

    def good(answer: Any) -> Any:
        if answer.isError():
            raise ValueError(answer.exception_code)
        return answer

    return {
        "holding": lambda a, n: good(client.read_holding_registers(a, count=n, device_id=unit)).registers,
        "input": lambda a, n: good(client.read_input_registers(a, count=n, device_id=unit)).registers,
        "coils": lambda a, n: good(client.read_coils(a, count=n, device_id=unit)).bits[:n],
        "discrete": lambda a, n: good(client.read_discrete_inputs(a, count=n, device_id=unit)).bits[:n],
        "write_register": lambda a, v: good(client.write_register(a, v, device_id=unit)),
        "write_registers": lambda a, v: good(client.write_registers(a, v, device_id=unit)),
        "write_coil": lambda a, v: good(client.write_coil(a, v, device_id=unit)),
        "write_coils": lambda a, v: good(client.write_coils(a, v, device_id=unit)),
    }
