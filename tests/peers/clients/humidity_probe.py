"""Read a probe with vaisala-pymodbus: `humidity_probe.py LINE`; prints what came.

It looks for a port that calls itself Vaisala, which a pseudo-terminal cannot, and was written for pymodbus 2, which
has a folder of its own.
"""

import json
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

sys.path.insert(0, str(Path(sys.executable).parents[1] / "pymodbus2"))

import serial.tools.list_ports

found: Any = [SimpleNamespace(device=sys.argv[1], description="Vaisala USB")]
vars(serial.tools.list_ports)["comports"] = lambda: found

from vaisala_pymodbus.vaisala_pymodbus import ModbusSensorClient  # noqa: E402  # after its environment

probe = ModbusSensorClient("found by its name")
said = {"connected": probe.connect()}
said |= {
    "floats": [
        probe.humidity(),
        probe.temperature(),
        probe.dew_point_temperature(),
        probe.wet_bulb_temperature(),
    ],
    "integers": [probe.humidity_int(), probe.temperature_int(), probe.dew_point_temperature_int()],
    "test_float": probe.read_measurement("floating_point"),
    "test_integer": probe.read_measurement("signed_integer"),
}
print("\n" + json.dumps(said))  # noqa: T201  # data for the test
