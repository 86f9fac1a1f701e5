"""Coordinates and quantities in the units that a client has chosen; inside all are mm, rad, °C and hPa.

Known are the numbers of units and kinds of coordinates (sheet `trackers_ballbar`, section 1). Not known, and assumed
here: a left-handed kind has the sign of its axis reversed; cylindrical coordinates come as radius, angle, height,
spherical ones as horizontal angle, zenith angle, distance; clockwise is seen from above.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.simulators.world.types import Floats

RIGHT_HANDED = 0
_LEFT_HANDED = {1: 0, 2: 1, 3: 2}
_CYLINDRICAL = {4: -1.0, 5: 1.0}
_SPHERICAL = {6: -1.0, 7: 1.0}
KINDS = range(8)

_MM = (1000.0, 1.0, 1e-3, 304.8, 914.4, 25.4)
_RAD = (1.0, math.pi / 180.0, math.pi / 200.0)
_HPA = (1.0, 1.0, 10.0, 1.333223874, 68.94757293, 2.490889, 33.86389)
COUNTS = (len(_MM), len(_RAD), 2, len(_HPA), 1)
"""How many units of length, angle, temperature, pressure and humidity there are."""


@dataclass(frozen=True)
class Units:
    """Units and coordinates of a client.

    Attributes:
        numbers: of the units of length, angle, temperature, pressure and humidity.
        kind: of coordinates.
    """

    numbers: tuple[int, ...] = (0, 0, 0, 0, 0)
    kind: int = RIGHT_HANDED

    def length(self, mm: float) -> float:
        """Return a length in the client's unit."""
        return mm / _MM[self.numbers[0]]

    def to_mm(self, length: float) -> float:
        """Return a length of the client's in mm."""
        return length * _MM[self.numbers[0]]

    def angle(self, rad: float) -> float:
        """Return an angle in the client's unit."""
        return rad / _RAD[self.numbers[1]]

    def to_rad(self, angle: float) -> float:
        """Return an angle of the client's in rad."""
        return angle * _RAD[self.numbers[1]]

    def temperature(self, celsius: float) -> float:
        """Return a temperature in the client's unit."""
        return celsius if self.numbers[2] == 0 else 32.0 + 1.8 * celsius

    def air(self, values: Sequence[float]) -> tuple[float, float, float]:
        """Return temperature, pressure and humidity, °C, hPa, %, in the client's units."""
        celsius, hpa, percent = values
        return self.temperature(celsius), hpa / _HPA[self.numbers[3]], percent

    def to_air(self, values: Sequence[float]) -> tuple[float, float, float]:
        """Return temperature, pressure and humidity of the client's in °C, hPa, %."""
        temperature, pressure, percent = values
        celsius = temperature if self.numbers[2] == 0 else (temperature - 32.0) / 1.8
        return celsius, pressure * _HPA[self.numbers[3]], percent

    def place(self, place_mm: Sequence[float]) -> tuple[float, float, float]:
        """Return a place of the instrument's frame in the client's coordinates."""
        x, y, z = place_mm
        if self.kind in _CYLINDRICAL:
            turn = _CYLINDRICAL[self.kind] * math.atan2(y, x)
            return self.length(math.hypot(x, y)), self.angle(turn), self.length(z)
        if self.kind in _SPHERICAL:
            distance = math.hypot(x, y, z)
            turn = _SPHERICAL[self.kind] * math.atan2(y, x)
            return self.angle(turn), self.angle(math.acos(z / distance)), self.length(distance)
        one, two, three = (self._sign(axis) * self.length(value) for axis, value in enumerate((x, y, z)))
        return one, two, three

    def to_place_mm(self, values: Sequence[float]) -> tuple[float, float, float]:
        """Return a place of the client's in the instrument's frame, mm."""
        one, two, three = values
        if self.kind in _CYLINDRICAL:
            turn = _CYLINDRICAL[self.kind] * self.to_rad(two)
            radius_mm = self.to_mm(one)
            return radius_mm * math.cos(turn), radius_mm * math.sin(turn), self.to_mm(three)
        if self.kind in _SPHERICAL:
            turn = _SPHERICAL[self.kind] * self.to_rad(one)
            return direction_mm(turn, self.to_rad(two), self.to_mm(three))
        x, y, z = (self._sign(axis) * self.to_mm(value) for axis, value in enumerate(values))
        return x, y, z

    def covariance(self, place_mm: Sequence[float], covariance_mm2: Floats) -> Floats:
        """Return a covariance at a place in the client's coordinates, shape (3, 3)."""
        steps = np.eye(3) * 1e-3
        near = np.array(
            [self.place(np.add(place_mm, sense * step)) for step in steps for sense in (1.0, -1.0)]
        )
        turned = (near[0::2] - near[1::2]).T / 2e-3
        return np.asarray(turned @ covariance_mm2 @ turned.T)

    def _sign(self, axis: int) -> float:
        return -1.0 if _LEFT_HANDED.get(self.kind) == axis else 1.0


def direction_mm(turn_rad: float, zenith_rad: float, distance_mm: float) -> tuple[float, float, float]:
    """Return the place in a direction and at a distance, in the instrument's frame."""
    level_mm = distance_mm * math.sin(zenith_rad)
    return level_mm * math.cos(turn_rad), level_mm * math.sin(turn_rad), distance_mm * math.cos(zenith_rad)


def angles_of(place_mm: Sequence[float]) -> tuple[float, float]:
    """Return the horizontal and the zenith angle of a place, rad."""
    x, y, z = place_mm
    return math.atan2(y, x), math.acos(z / math.hypot(x, y, z))
