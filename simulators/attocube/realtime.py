"""The IDS's service realtime: which signals its fast outputs carry. Settings are kept and have no effect.

Names, ranges and which setters wait for `apply` come from the maker's API (sheet `interferometers`, section 4). The
first values and the largest gap of the older generation are assumptions.
"""

from dataclasses import dataclass
from functools import partial
from typing import Literal

from catseye.simulators.attocube.errors import AXES, OUT_OF_RANGE, IdsError, checked, checked_axis
from catseye.simulators.attocube.results import Method
from catseye.simulators.attocube.staged import Staged

_CLOCK_NS = 40
_ABSOLUTE, _VIBROMETRY = 2, 3
_HSSL, _LINEAR, _BISS_C = (0, 1), (6, 7), 8


@dataclass(frozen=True)
class _Number:
    """A numeric setting: its range, its step, and whether it waits for `apply`."""

    lowest: int
    highest: int
    step: int = 1
    waits: bool = True


_COMMON = {
    "RtOutMode": _Number(0, 9),
    "RtDistanceMode": _Number(1, 3),
    "ResolutionHsslLow": _Number(0, 46),
    "PeriodHsslClk": _Number(40, 10_200, _CLOCK_NS),
    "PeriodSinCosClk": _Number(40, 10_200, _CLOCK_NS),
    "ResolutionSinCos": _Number(1, 65_535),
    "LinearRange": _Number(0, 34, waits=False),
    "HighPassCutOffFreq": _Number(1, 24, waits=False),
}
_OLDER = {
    "ResolutionBissC": _Number(1, 65_535),
    "ResolutionHsslHigh": _Number(0, 46),
    "PeriodHsslGap": _Number(0, 255),
}
_NEWER = {
    "ResolutionBissC": _Number(0, 16),
    "ResolutionHsslHigh": _Number(1, 47),
    "PeriodHsslGap": _Number(1, 255),
}
_WINDOWS = {"ids": 5, "sen": 4}


class Realtime:
    """The service.

    Args:
        dialect: generation of the instrument.
        shows_pending: see `Staged`.
    """

    def __init__(self, dialect: Literal["ids", "sen"], *, shows_pending: bool) -> None:
        self._dialect = dialect
        self._numbers = _COMMON | (_NEWER if dialect == "sen" else _OLDER)
        first = {name: number.lowest for name, number in self._numbers.items()}
        others = {"AafEnabled": False, "AafAttenuation": 3, "AafWindow": 0, "InvertedErrorSignal": False}
        axes = {f"RtAxis{axis}": True for axis in AXES}
        self._settings = Staged({**first, **others, **axes}, shows_pending=shows_pending)

    def methods(self) -> dict[str, Method]:
        """Return what it can do, by name."""
        found: dict[str, Method] = {"apply": self._settings.apply, "discard": self._settings.discard}
        for name in (*self._numbers, "AafEnabled", "AafAttenuation", "AafWindow"):
            found[f"get{name}"] = partial(self._settings.get, name)
        for name, number in self._numbers.items():
            found[f"set{name}"] = partial(self._set, name, number)
        found["setAaf"] = self._set_filter
        return {f"realtime.{name}": method for name, method in (found | self._others()).items()}

    def _others(self) -> dict[str, Method]:
        if self._dialect == "ids":
            return {"AafIsEnabled": partial(self._settings.get, "AafEnabled")}
        inverted = "InvertedErrorSignal"
        return {
            f"get{inverted}": partial(self._settings.get, inverted),
            f"set{inverted}": lambda on: self._settings.put(inverted, bool(on)),
            "enableRtAxis": lambda axis, on: self._settings.put(f"RtAxis{checked_axis(axis)}", bool(on)),
            "getRtAxisEnabled": lambda axis: self._settings.get(f"RtAxis{checked_axis(axis)}"),
        }

    def _set(self, name: str, number: _Number, value: int) -> list[object]:
        kept = round(checked(value, number.lowest, number.highest) / number.step) * number.step
        if name == "RtDistanceMode":
            self._check_distance(kept)
        return self._settings.set(name, kept) if number.waits else self._settings.put(name, kept)

    def _check_distance(self, mode: int) -> None:
        """Refuse a distance mode that the output mode does not have."""
        output = self._settings.wanted["RtOutMode"]
        absolute = output in _HSSL or (output == _BISS_C and self._dialect == "sen")
        if (mode == _ABSOLUTE and not absolute) or (mode == _VIBROMETRY and output not in _LINEAR):
            raise IdsError(OUT_OF_RANGE)

    def _set_filter(self, enabled: bool | int, attenuation_db: int, window: int) -> list[object]:
        self._settings.put("AafAttenuation", checked(attenuation_db, 3, 30))
        self._settings.put("AafWindow", checked(window, 0, _WINDOWS[self._dialect]))
        return self._settings.put("AafEnabled", bool(enabled))
