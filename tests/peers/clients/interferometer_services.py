"""Call what the maker's public Python API offers beside measuring: `interferometer_services.py HOST PORT`.

Prints, for an idle instrument and for one that measures, what each call gave; a call that the API refuses gives the
text of its exception.
"""

import importlib
import json
import sys
import time
from collections.abc import Callable
from typing import Any

# The package around it needs a desktop; the API itself does not.
for path in list(sys.path):
    sys.path.append(f"{path}/feather_xrol")
api = importlib.import_module("ids_api.SEN")
acs = importlib.import_module("ids_api.ACS")

device = api.Device(sys.argv[1])
device.TCP_PORT = int(sys.argv[2])
device.connect()


def given(call: Callable[..., Any], *arguments: Any) -> Any:
    """Return what a call gives, or what it complains of."""
    try:
        return call(*arguments)
    except acs.AttoException as error:
        return str(error.errorText)


def plural() -> dict[str, Any]:
    """Return what the calls about all axes give."""
    names = ("getAxesDisplacement", "getAbsolutePositions", "getReferencePositions")
    found = {name: given(getattr(device.displacement, name)) for name in names}
    return found | {
        "quality": given(device.displacement.getAxisSignalQuality, 0),
        "contrast": given(device.adjustment.getContrastInPermille, 0),
    }


def settings() -> dict[str, Any]:
    """Set what the API applies by itself, return what it reads afterwards."""
    device.axis.setPassMode(1)
    device.axis.setMasterAxis(2)
    device.realtime.setRtOutMode(1)
    device.realtime.setRtDistanceMode(2)
    device.realtime.setPeriodHsslClk(95)
    device.realtime.setAaf(True, 12, 4)
    device.network.setIpAddress("192.0.2.9")
    device.network.verify()
    device.network.apply()
    return {
        "pass_mode": device.axis.getPassMode(),
        "master": device.axis.getMasterAxis(),
        "axes": device.axis.getSupportedAxes(),
        "output": device.realtime.getRtOutMode(),
        "distance": device.realtime.getRtDistanceMode(),
        "clock_ns": device.realtime.getPeriodHsslClk(),
        "window": device.realtime.getAafWindow(),
        "refused": given(device.realtime.setRtOutMode, 10),
        "address": device.network.getRealIpAddress(),
        "radio": device.network.getWifiPresent(),
        "passphrase": given(device.network.getWifiPassphrase),
    }


def tables() -> dict[str, Any]:
    """Create a correction table and apply it, return what is known of it."""
    device.nlc.createLut(0)
    device.nlc.setLutApplied(0, True)
    device.nlc.analyzeNonlinearities(0)
    return {
        "status": device.nlc.getLutStatus(0),
        "applied": device.nlc.getLutApplied(0),
        "points": len(json.loads(device.nlc.getLutInPm(0))),
        "curve": len(json.loads(device.nlc.getNonlinearityErrorCurveInPm(0))),
    }


def itself() -> dict[str, Any]:
    """Ask the device about itself, state the air by hand, lock and unlock it."""
    device.manual.setTemperatureInDegrees(-1, 21.5)
    device.manual.setRefractiveIndex(-1, 1.00026)
    device.ecu.setRefractiveIndexCompensationMode(-1, 2)
    device.system_service.setDeviceName("bench 3")
    device.access.lock("secret")
    locked = device.access.getLockStatus()
    device.access.unlock("secret")
    packages = device.about.getInstalledPackages()
    return {
        "temperature": device.manual.getTemperatureInDegrees(-1),
        "index": device.ecu.getRefractiveIndexForCompensation(-1),
        "pressure": given(device.manual.setPressureInHPa, -1, 700.0),
        "name": device.system_service.getDeviceName(),
        "recommendation": device.system_service.errorNumberToRecommendation(0, 1),
        "locked": locked,
        "unlocked": device.access.getLockStatus(),
        "license": device.about.getPackageLicense(packages.split(",")[0]),
        "progress": device.update.getSwUpdateProgress(),
        "update": given(device.update.softwareUpdateBase64),
    }


said = {
    "itself": itself(),
    "idle": plural(),
    "settings": settings(),
    "no table": given(device.nlc.createLut, 0),
}
device.system.startMeasurement()
for _ in range(200):
    if device.system.getCurrentMode() == "measurement running":
        break
    time.sleep(0.05)
said |= {"running": plural(), "tables": tables()}
device.close()
print("\n" + json.dumps(said))  # noqa: T201  # data for the test
