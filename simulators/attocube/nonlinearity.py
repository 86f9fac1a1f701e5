"""The IDS's service nlc: tables that correct the nonlinearity within one fringe.

Names, parameters, layouts and the mode in which an estimation is possible come from the maker's API (sheet
`interferometers`, section 4). The emulated interferometer is linear within its noise: estimations find zeros, and
tables are kept and have no effect. Assumed: the number of fringes that an estimation looks at; that a table has to
exist before it is applied or read.
"""

import json
from collections.abc import Callable
from functools import partial
from typing import Literal

from catseye.simulators.attocube.errors import AXES, NO_TABLE, OUT_OF_RANGE, IdsError, checked, checked_axis
from catseye.simulators.attocube.results import Later, Method

_POINTS = 512
_FRINGES = 16
_ON_UM_S, _OFF_UM_S = 10, 5

Estimate = Callable[[int, Callable[[], list[object]]], Later]
"""Called with an axis and with what to do once the estimation has succeeded."""


class Nonlinearity:
    """The service.

    Args:
        dialect: generation of the instrument.
        estimate: occupies the instrument for the time of an estimation.
    """

    def __init__(self, dialect: Literal["ids", "sen"], estimate: Estimate) -> None:
        self._dialect = dialect
        self._estimate = estimate
        self._tables: dict[int, list[int]] = {}
        self._applied: set[int] = set()
        self._fringes: dict[int, int] = {}
        self._analysed: set[int] = set()
        self._during_start = False
        self._modes = dict.fromkeys(AXES, 0)
        self._thresholds_um_s = (_ON_UM_S, _OFF_UM_S)

    def methods(self) -> dict[str, Method]:
        """Return what it can do, by name."""
        common: dict[str, Method] = {
            "createLut": lambda axis: self._estimate(checked_axis(axis), partial(self._created, axis)),
            "getLutApplied": lambda axis: [0, checked_axis(axis) in self._applied],
            "setLutApplied": self._set_applied,
            "getLutStatus": lambda axis: [0, checked_axis(axis) in self._tables],
        }
        found = common | (self._newer() if self._dialect == "sen" else self._older())
        return {f"nlc.{name}": method for name, method in found.items()}

    def _older(self) -> dict[str, Method]:
        return {
            "clearLut": self._clear_table,
            "estimateNonlinearities": self._analyse,
            "getDynamicNormalization": lambda axis: [0, self._modes[checked_axis(axis)]],
            "setDynamicNormalization": self._set_mode,
            "getHistogram": self._list,
            "getLut": self._table,
            "setLut": self._upload,
            "getNonlinearityEstimation": lambda: [0, _zeros()],
            "getVelocityThresholds": lambda: [0, *self._thresholds_um_s],
            "setVelocityThresholds": self._set_thresholds,
        }

    def _newer(self) -> dict[str, Method]:
        return {
            "analyzeNonlinearities": self._analyse,
            "clearAll": self._clear_all,
            "getAnalysisStatus": lambda axis: [0, checked_axis(axis) in self._analysed],
            "getLutDuringInit": lambda: [0, self._during_start],
            "setLutDuringInit": self._set_during_start,
            "getLutInPm": self._table,
            "setLutInPm": self._upload,
            "getNonlinearityErrorCurveInPm": self._curve,
            "getNonlinearityErrorCurvesInPm": self._curves,
            "getNonlinearityErrorListInPm": self._list,
        }

    def _created(self, axis: int) -> list[object]:
        self._fringes[axis] = _FRINGES
        self._tables.setdefault(axis, [0] * _POINTS)
        return [0]

    def _analyse(self, axis: int) -> Later:
        return self._estimate(checked_axis(axis), partial(self._analysis, axis))

    def _analysis(self, axis: int) -> list[object]:
        self._fringes[axis] = _FRINGES
        self._analysed.add(axis)
        return [0]

    def _clear_table(self, axis: int) -> list[object]:
        self._tables.pop(checked_axis(axis), None)
        self._applied.discard(axis)
        return [0]

    def _clear_all(self, axis: int) -> list[object]:
        self._clear_table(axis)
        self._fringes.pop(axis, None)
        self._analysed.discard(axis)
        return [0]

    def _table(self, axis: int) -> list[object]:
        _require(checked_axis(axis) in self._tables)
        return [0, json.dumps(self._tables[axis])]

    def _upload(self, axis: int, table: str) -> list[object]:
        points = json.loads(table)
        if not isinstance(points, list) or len(points) != _POINTS or not all(type(p) is int for p in points):
            raise IdsError(OUT_OF_RANGE)
        self._tables[checked_axis(axis)] = points
        return [0]

    def _set_applied(self, axis: int, on: bool) -> list[object]:
        if not on:
            self._applied.discard(checked_axis(axis))
            return [0]
        _require(checked_axis(axis) in self._tables)
        self._applied.add(axis)
        return [0]

    def _set_during_start(self, on: bool) -> list[object]:
        self._during_start = bool(on)
        return [0]

    def _curve(self, axis: int) -> list[object]:
        _require(checked_axis(axis) in self._analysed)
        return [0, _zeros()]

    def _curves(self, axis: int) -> list[object]:
        _require(checked_axis(axis) in self._fringes)
        return [0, json.dumps([[0] * _POINTS] * self._fringes[axis])]

    def _list(self, axis: int) -> list[object]:
        _require(checked_axis(axis) in self._fringes)
        return [0, json.dumps([0] * self._fringes[axis])]

    def _set_mode(self, axis: int, mode: int) -> list[object]:
        self._modes[checked_axis(axis)] = checked(mode, 0, 2)
        return [0]

    def _set_thresholds(self, on_um_s: int, off_um_s: int) -> list[object]:
        if not 0 <= off_um_s <= on_um_s:
            raise IdsError(OUT_OF_RANGE)
        self._thresholds_um_s = (on_um_s, off_um_s)
        return [0]


def _require(there: bool) -> None:
    if not there:
        raise IdsError(NO_TABLE)


def _zeros() -> str:
    return json.dumps([0] * _POINTS)
