"""Measure with the interferometer maker's public Python API: `displacements.py HOST`; prints what it read."""

import importlib
import json
import sys
import time

# The package around it needs a desktop; the API itself does not.
for path in list(sys.path):
    sys.path.append(f"{path}/feather_xrol")
api = importlib.import_module("ids_api.SEN")

device = api.Device(sys.argv[1])
device.connect()
mode = device.system.getCurrentMode()
if mode == "system idle":
    device.system.startMeasurement()
for _ in range(100):
    if device.system.getCurrentMode() == "measurement running":
        break
    time.sleep(0.05)
said = {
    "mode": device.system.getCurrentMode(),
    "enabled": device.displacement.getMeasurementEnabled(),
    "displacement_pm": device.displacement.getAxisDisplacement(0),
    "average": device.displacement.getAverageN(),
}
device.close()
print("\n" + json.dumps(said))  # noqa: T201  # data for the test
