"""The IDS's service ecu.manual: air, or its index, that somebody states instead of the environment unit.

Names, parameters and ranges come from the maker's API (manual.py), which takes the index of stated air from Ciddor's
equation. What is stated at first is an assumption.
"""

import math
from collections.abc import Callable
from functools import partial

from catseye.calibration.air import HE_NE_VACUUM_NM, refractive_index
from catseye.simulators.attocube.errors import OUT_OF_RANGE, IdsError
from catseye.simulators.attocube.results import Method

_RANGES = {
    "TemperatureInDegrees": (-40.0, 100.0),
    "PressureInHPa": (800.0, 1200.0),
    "HumidityInPercent": (0.0, 100.0),
}
_FIRST = {"TemperatureInDegrees": 20.0, "PressureInHPa": 1013.25, "HumidityInPercent": 50.0}
_INDEX, _FIRST_INDEX = "RefractiveIndex", 1.000271


class Manual:
    """The service.

    Args:
        axes: returns the axes that a parameter means, itself the first one; an error where there are none.
        every: all axes, with the one that means all of them.
    """

    def __init__(self, axes: Callable[[int], tuple[int, ...]], every: tuple[int, ...]) -> None:
        self._axes = axes
        self._stated = {axis: {**_FIRST, _INDEX: _FIRST_INDEX} for axis in every}

    def methods(self) -> dict[str, Method]:
        """Return what it can do, by name."""
        found: dict[str, Method] = {}
        for name in (*_RANGES, _INDEX):
            found[f"get{name}"] = partial(self._get, name)
            found[f"set{name}"] = partial(self._set, name)
        return {f"manual.{name}": method for name, method in found.items()}

    def index(self, axis: int) -> float:
        """Return the index that is stated."""
        return self._stated[axis][_INDEX]

    def index_of_air(self, axis: int) -> float:
        """Return the index of the air that is stated."""
        temperature_c, pressure_hpa, humidity_percent = (self._stated[axis][name] for name in _FIRST)
        index = refractive_index(
            HE_NE_VACUUM_NM, temperature_c, pressure_hpa, humidity_percent, formula="ciddor"
        )
        return float(index)

    def _get(self, name: str, axis: int) -> list[object]:
        return [0, self._stated[self._axes(axis)[0]][name]]

    def _set(self, name: str, axis: int, value: float) -> list[object]:
        axes, stated = self._axes(axis), float(value)
        low, high = _RANGES.get(name, (math.nextafter(1.0, 2.0), math.inf))
        if not low <= stated <= high or math.isinf(stated):
            raise IdsError(OUT_OF_RANGE)
        for one in axes:
            self._stated[one][name] = stated
        return [0]
