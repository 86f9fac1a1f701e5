"""Numbers of emScon's interface: commands, states, units (sheet `trackers_ballbar`, section 1)."""

from enum import IntEnum
from typing import Final


class Command(IntEnum):
    """Commands."""

    SYSTEM_STATUS = 1
    TRACKER_STATUS = 2
    SET_UNITS = 5
    UNITS = 6
    INITIALIZE = 7
    SET_ENVIRONMENT = 20
    ENVIRONMENT = 21
    REFRACTION = 23
    SET_MODE = 24
    MODE = 25
    SET_COORDINATES = 26
    COORDINATES = 27
    SET_STATIONARY = 28
    SET_REFLECTOR = 40
    REFLECTOR = 41
    REFLECTORS = 42
    SET_SEARCH = 43
    SET_SETTINGS = 47
    SETTINGS = 48
    START_MEASUREMENT = 49
    STOP_MEASUREMENT = 52
    CHANGE_FACE = 53
    GO_POSITION = 55
    FIND_REFLECTOR = 63
    SET_STATISTIC = 80
    FACE = 98
    TRACKER_INFO = 132
    SOFTWARE_VERSION = 142


OK: Final = 0
BUSY: Final = 1
NOT_IMPLEMENTED: Final = 2

INITIALISED: Final = 5
"""State of the tracker's processor."""

TRACKER_NOT_READY, TRACKER_READY = 0, 2
"""States of the tracker: without a target, and locked on one."""

LASER_HEATING, LASER_READY = 2, 3
_LASERS: Final = {
    0: "no communication with the laser",
    1: "no laser",
    LASER_HEATING: "laser heating up",
    LASER_READY: "laser ready",
    4: "laser cannot be stabilised",
    5: "laser off",
}

UNITS: Final = (1, 1, 0, 1, 0)
"""mm, degrees, °C, hPa, per cent of relative humidity."""

RIGHT_HANDED: Final = 0
"""Rectangular right-handed coordinates."""

STANDARD: Final = 0
EXTENDED: Final = 1
"""Results without and with covariances."""

STATIONARY: Final = 0
"""Mode of measuring: a target that stands still."""

SENSORS: Final = {13: "AT901-B", 14: "AT901-MR", 15: "AT901-LR", 70: "AT401"}
"""Types of trackers; older ones have lower numbers."""

REFUSED: Final = frozenset({2, *range(3, 11), 34, 35, 36, 38, 39, 46, 57, 58, 59})
"""Status values whose reason is not that no target is seen."""

NO_TARGET: Final = frozenset({37, 10004, 10009})
"""Status values that say themselves that the beam does not return, or did not all the time."""

_STATUS_TEXTS: Final = {
    1: "the tracker is busy with another command",
    2: "this tracker does not know the command",
    3: "a parameter is wrong",
    23: "the reflector in use is another one",
    26: "no tracker processor is found",
    28: "there is no point measured before",
    30: "there is no distance meter",
    34: "the licence has expired",
    35: "the command conflicts with how the tracker is used now",
    36: "an unknown command or an unknown reason",
    37: "no distance is set: the tracker is not locked on a target",
    38: "no tracker is connected to its controller",
    39: "the tracker is not initialised",
    46: "another program has the tracker under its control",
    57: "temperature, pressure or humidity are out of the range of the refraction formula",
    58: "a compensation is under way",
    10004: "the tracker is not ready to measure",
    10009: "the stationary measurement gave no result",
    10011: "the controller takes one connection only: end the other program",
    10012: "the sensor has not warmed up",
    10013: "the sensor is not stable",
    10014: "the system is not ready to measure",
}


def status_text(status: int) -> str:
    """Return what a status of a reply means, with its number."""
    if 4 <= status <= 10:
        return f"parameter {status - 3} is wrong (status {status})"
    if 11 <= status <= 22:
        return f"parameter {(status - 9) // 2} is out of range (status {status})"
    return f"{_STATUS_TEXTS.get(status, 'no known reason')} (status {status})"


def laser_text(state: int) -> str:
    """Return the state of the laser in words."""
    return _LASERS.get(state, f"laser in the unknown state {state}")
