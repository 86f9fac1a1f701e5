"""Call a Modbus library: `modbus_calls.py LIBRARY tcp|rtu AIR IO`; prints what it read and wrote.

AIR and IO are ports of 127.0.0.1 or serial lines: a sensor with Vaisala's map and a block of inputs and outputs. Over
serial lines the sensor has address 7 at 19200 8E1, the block address 1 at 115200 8N1; over TCP the unit is 1.
"""

import importlib
import json
import os
import sys
from collections.abc import Callable
from typing import Any

from pseudo_terminal import take_parity

Calls = dict[str, Callable[..., Any]]


def tried(calls: Calls, name: str, *arguments: Any) -> Any:
    """Return what a call gives as plain numbers, None if the library has no such call."""
    if name not in calls:
        return None
    given = calls[name](*arguments)
    return [int(value) for value in given] if name in {"holding", "input", "coils", "discrete"} else None


def refused(calls: Calls, name: str, *arguments: Any) -> str:
    """Return how the library shows a refusal."""
    try:
        given = calls[name](*arguments)
    except Exception as error:  # noqa: BLE001  # every library has its own
        return f"{type(error).__name__}: {error}"
    return str(given)


def sensor(calls: Calls) -> dict[str, Any]:
    """Read the map, write the register of the pressure's temporary default."""
    said = {
        "holding": tried(calls, "holding", 0, 4),
        "input": tried(calls, "input", 0, 4),
        "integers": tried(calls, "holding", 256, 2),
        "status": tried(calls, "holding", 512, 2),
        "refused": refused(calls, "holding", 20_000, 1),
    }
    tried(calls, "write_register", 770, 0x1234)
    said["written"] = tried(calls, "holding", 770, 1)
    tried(calls, "write_registers", 770, [0, 0x447D])
    return said | {"both_written": tried(calls, "holding", 770, 2)}


def block(calls: Calls) -> dict[str, Any]:
    """Write coils one by one and together, read them and the inputs."""
    tried(calls, "write_coils", 4, [False, False, False])
    tried(calls, "write_coil", 4, True)
    one = tried(calls, "coils", 4, 3)
    tried(calls, "write_coils", 4, [True, False, True])
    together = tried(calls, "coils", 4, 3)
    return {"one": one, "together": together, "inputs": tried(calls, "discrete", 0, 3)}


def main(name: str, link: str, air: str, io: str) -> None:
    """Print what the library gives."""
    take_parity()
    library = importlib.import_module(f"modbus_libraries.{name}")
    if link == "tcp":
        said = sensor(library.tcp(int(air))), block(library.tcp(int(io)))
    else:
        said = sensor(library.rtu(air, 19200, "E", 7)), block(library.rtu(io, 115200, "N", 1))
    print("\n" + json.dumps(said[0] | said[1]), flush=True)  # noqa: T201  # data for the test
    # Some libraries leave a thread behind that reads for ever.
    os._exit(0)


if __name__ == "__main__":
    main(*sys.argv[1:])
