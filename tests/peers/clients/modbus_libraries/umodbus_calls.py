"""uModbus."""

import socket
from typing import Any

import serial
from umodbus.client import tcp as over_tcp
from umodbus.client.serial import rtu as over_rtu

Calls = dict[str, Any]


def tcp(port: int) -> Calls:
    """Return its calls over TCP."""
    return _calls(over_tcp, socket.create_connection(("127.0.0.1", port), 5.0), 1)


def rtu(line: str, baud: int, parity: str, unit: int) -> Calls:
    """Return its calls over a serial line."""
    return _calls(over_rtu, serial.Serial(line, baud, parity=parity, timeout=1.0), unit)


def _calls(module: Any, link: Any, unit: int) -> Calls:
    def call(name: str) -> Any:
        return lambda address, value: module.send_message(getattr(module, name)(unit, address, value), link)

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
