"""The IDS's service ecu: what its environment unit measures, and which index its lengths are divided by.

Names and the meaning of the modes come from the maker's API (ecu.py). Assumed: the unit's index is Edlén's of
helium-neon light; stated air and a stated index act, like the unit, only while the unit is enabled.
"""

from typing import Literal

from catseye.calibration.air import HE_NE_VACUUM_NM, refractive_index
from catseye.simulators.attocube.errors import AXES, NO_UNIT, OUT_OF_RANGE, IdsError, checked, checked_axis
from catseye.simulators.attocube.manual import Manual
from catseye.simulators.attocube.results import Method
from catseye.simulators.lengths import Lengths
from catseye.simulators.world.air import AirSample
from catseye.simulators.world.air_probe import AirProbe
from catseye.simulators.world.counter import Reading

_DECIMALS = 9
_ALL = -1
_BY_UNIT, _BY_STATED_AIR = 0, 1


class Environment:
    """The service.

    Args:
        probe: what the unit measures.
        dialect: generation of the instrument.
        axis: the one that looks at the bench.
        enabled: the unit corrects from the start.
        by_axis: axes are compensated one by one.
    """

    def __init__(
        self, probe: AirProbe, dialect: Literal["ids", "sen"], axis: int, *, enabled: bool, by_axis: bool
    ) -> None:
        self._probe = probe
        self._dialect = dialect
        self._axis = axis
        self._enabled = enabled
        self._by_axis = by_axis
        self._modes = dict.fromkeys((_ALL, *AXES), _BY_UNIT)
        self._manual = Manual(self._axes, (_ALL, *AXES))

    def methods(self) -> dict[str, Method]:
        """Return what it can do, by name."""
        older: dict[str, Method] = {
            "isEnabled": lambda: [0, self._enabled],
            "isConnected": lambda: [0, True],
        }
        found: dict[str, Method] = {
            "enable": lambda: self._enable(on=True),
            "disable": lambda: self._enable(on=False),
            "getTemperatureInDegrees": lambda: [0, self._air().temperature_c],
            "getPressureInHPa": lambda: [0, self._air().pressure_hpa],
            "getHumidityInPercent": lambda: [0, self._air().humidity_percent],
            "getRefractiveIndex": lambda: [0, round(self._index_by_unit(), _DECIMALS)],
            "getEnabled": lambda: [0, self._enabled],
            "getConnected": lambda: [0, True],
            "getRefractiveIndexCompensationMode": lambda axis: [0, self._modes[self._axes(axis)[0]]],
            "setRefractiveIndexCompensationMode": self._set_mode,
            "getRefractiveIndexForCompensation": self._index_of,
            **self._manual.methods(),
        }
        found |= older if self._dialect == "ids" else {}
        return {f"com.attocube.ecu.{name}": method for name, method in found.items()}

    def shown_mm(self, reading: Reading, sign: int) -> float:
        """Return a displacement with the compensation that acts."""
        if self._enabled and self._modes[self._axis] != _BY_UNIT:
            return sign * reading.vacuum_mm / self._stated_index(self._axis)
        return Lengths(self._enabled, sign).shown_mm(reading)

    def shown_part(self, true_index: float) -> float:
        """Return what a length is shown as, as a part of it, in air of an index."""
        if not self._enabled:
            return true_index
        by_unit = self._modes[self._axis] == _BY_UNIT
        return 1.0 if by_unit else true_index / self._stated_index(self._axis)

    def _stated_index(self, axis: int) -> float:
        by_air = self._modes[axis] == _BY_STATED_AIR
        return self._manual.index_of_air(axis) if by_air else self._manual.index(axis)

    def _air(self) -> AirSample:
        sample = self._probe.sample()
        if sample is None:
            raise IdsError(NO_UNIT)
        return sample

    def _index_by_unit(self) -> float:
        air = self._air()
        index = refractive_index(
            HE_NE_VACUUM_NM, air.temperature_c, air.pressure_hpa, air.humidity_percent, formula="edlen"
        )
        return float(index)

    def _index_of(self, axis: int) -> list[object]:
        one = self._axes(axis)[0]
        index = self._index_by_unit() if self._modes[one] == _BY_UNIT else self._stated_index(one)
        return [0, round(index, _DECIMALS)]

    def _enable(self, *, on: bool) -> list[object]:
        self._enabled = on
        return [0]

    def _set_mode(self, axis: int, mode: int) -> list[object]:
        self._modes.update(dict.fromkeys(self._axes(axis), checked(mode, 0, 2)))
        return [0]

    def _axes(self, axis: int) -> tuple[int, ...]:
        """Return the axes that a parameter means, itself the first one."""
        if axis == _ALL:
            return (_ALL, *AXES)
        if not self._by_axis:
            raise IdsError(OUT_OF_RANGE)
        return (checked_axis(axis),)
