"""Measure with CESAPI, the public emScon client: `tracker_point.py HOST PORT X Y Z`, in m; prints what came.

The units are those with which the server begins.
"""

import importlib
import json
import sys

command = importlib.import_module("CESAPI.command")
connection = importlib.import_module("CESAPI.connection")
packet = importlib.import_module("CESAPI.packet")

link = connection.Connection()
link.connect(host=sys.argv[1], port=int(sys.argv[2]))
tracker = command.CommandSync(link)
place_m = [float(value) for value in sys.argv[3:]]


def point_m() -> list[float]:
    """Measure what the beam is locked on."""
    result = tracker.StartMeasurement()
    return [result.dVal1, result.dVal2, result.dVal3]


try:
    tracker.Initialize()
    system = tracker.GetSystemSettings().systemSettings
    system.bSendUnsolicitedMessages = 1
    tracker.SetSystemSettings(system)
    tracker.SetCoordinateSystemType(0)
    tracker.SetMeasurementMode(0)
    stationary = packet.StationaryModeDataT()
    stationary.lMeasTime, stationary.bUseADM = 1000, 1
    tracker.SetStationaryModeParams(stationary)
    tracker.GoPosition(1, *place_m)
    said: dict[str, object] = {"place_m": point_m()}
    info, status = tracker.GetTrackerInfo(), tracker.GetSystemStatus()
    units = tracker.GetUnits().unitsSettings
    said |= {
        "name": info.cTrackerName.decode("utf-16-le").rstrip("\0"),
        "faces": info.iNumberOfFaces,
        "processor": status.trackerProcessorStatus,
        "units": [units.lenUnitType, units.angUnitType],
        "temperature_c": tracker.GetEnvironmentParams().environmentData.dTemperature,
        "index": tracker.GetRefractionParams().refractionData.dAdmRefractionIndex,
        "face": tracker.GetFace().trackerFace,
    }
    tracker.ChangeFace()
    said |= {"other_face": tracker.GetFace().trackerFace, "again_m": point_m()}
    tracker.StartNivelMeasurement()
    said["tilt"] = [tracker.nivel_measurement.dXTilt, tracker.nivel_measurement.dYTilt]
    tracker.GoBirdBath()
    said["home_m"] = point_m()
    try:
        tracker.GoPosition(1, 0.1, 0.2, 3.0)
    except Exception as error:  # noqa: BLE001  # the client has no other kind of error
        said["refused"] = str(error)
    # Of the packets with reflectors the client waits for the first.
    reflector = tracker.GetReflectors()
    said |= {
        "reflectors": reflector.iTotalReflectors,
        "reflector": reflector.cReflectorName.decode("utf-16-le").rstrip("\0"),
    }
finally:
    link.disconnect()
print(json.dumps(said))  # noqa: T201  # for the test that started this
