"""Poses and commands that lie outside of what a SCARA or its map covers."""

from catseye.calibration.core.errors import CalibrationError


class OutOfReachError(CalibrationError):
    """A position lies outside the ring that the arm reaches."""


class MapRangeError(CalibrationError):
    """An angle lies outside the nodes of an error map; maps are never extrapolated."""
