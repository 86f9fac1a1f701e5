"""uModbus."""

import socket
from typing import Any

import serial
from umodbus.client import tcp as over_tcp
from umodbus.client.serial import rtu as over_rtu

from modbus_libraries.standard_names import Calls, by_standard_names


def tcp(port: int) -> Calls:
    """Return its calls over TCP."""
    return _calls(over_tcp, socket.create_connection(("127.0.0.1", port), 5.0), 1)


def rtu(line: str, baud: int, parity: str, unit: int) -> Calls:
    """Return its calls over a serial line."""
    return _calls(over_rtu, serial.Serial(line, baud, parity=parity, timeout=1.0), unit)


def _calls(module: Any, link: Any, unit: int) -> Calls:
    def call(name: str) -> Any:
        return lambda address, value: module.send_message(getattr(module, name)(unit, address, value), link)

    return by_standard_names(call)
