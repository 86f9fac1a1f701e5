"""async-modbus, over connections of connio and pyserial-asyncio."""

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any

import serial_asyncio
from async_modbus import AsyncRTUClient, modbus_for_url

Calls = dict[str, Any]


def tcp(port: int) -> Calls:
    """Return its calls over TCP."""

    async def opened() -> Any:
        return modbus_for_url(f"tcp://127.0.0.1:{port}")

    return _calls(opened, 1)


def rtu(line: str, baud: int, parity: str, unit: int) -> Calls:
    """Return its calls over a serial line."""

    async def opened() -> Any:
        return AsyncRTUClient(
            await serial_asyncio.open_serial_connection(url=line, baudrate=baud, parity=parity)
        )

    return _calls(opened, unit)


def _calls(opened: Callable[[], Coroutine[None, None, Any]], unit: int) -> Calls:
    loop = asyncio.new_event_loop()
    client = loop.run_until_complete(opened())

    def call(name: str) -> Any:
        return lambda address, value: loop.run_until_complete(
            asyncio.wait_for(getattr(client, name)(unit, address, value), 5.0)
        )

    return {
        "holding": call("read_holding_registers"),
        "input": call("read_input_registers"),
        "coils": call("read_coils"),
        "discrete": call("read_discrete_inputs"),
        "write_register": call("write_register"),
        "write_registers": call("write_registers"),
        "write_coil": call("write_coil"),
        "write_coils": call("write_coils"),
    }
