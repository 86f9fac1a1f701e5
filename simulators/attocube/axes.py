"""The IDS's service axis: pass mode and master axis. Settings are kept and have no effect on lengths."""

from functools import partial
from typing import Literal

from catseye.simulators.attocube.errors import AXES, checked, checked_axis
from catseye.simulators.attocube.results import Method
from catseye.simulators.attocube.staged import Staged

_PASS_MODES = {"ids": 3, "sen": 1}
"""Highest pass mode; public clients of the older generation name two more sensor heads."""


class AxisService:
    """The service.

    Args:
        dialect: generation of the instrument.
        master: the master axis of a fresh instrument.
        shows_pending: see `Staged`.
    """

    def __init__(self, dialect: Literal["ids", "sen"], master: int, *, shows_pending: bool) -> None:
        self._dialect = dialect
        self._settings = Staged({"mode": 0, "master": master, "auto": True}, shows_pending=shows_pending)

    def methods(self) -> dict[str, Method]:
        """Return what it can do, by name."""
        highest = _PASS_MODES[self._dialect]
        found: dict[str, Method] = {
            "apply": self._settings.apply,
            "discard": self._settings.discard,
            "getPassMode": partial(self._settings.get, "mode"),
            "setPassMode": lambda mode: self._settings.set("mode", checked(mode, 0, highest)),
            "getMasterAxis": partial(self._settings.get, "master"),
            "setMasterAxis": lambda axis: self._settings.set("master", checked_axis(axis)),
        }
        newer: dict[str, Method] = {
            "getAutoMasterAxis": partial(self._settings.get, "auto"),
            "setAutoMasterAxis": lambda on: self._settings.put("auto", bool(on)),
            "getSupportedAxes": lambda: [0, *(True for _ in AXES)],
        }
        found |= newer if self._dialect == "sen" else {}
        return {f"axis.{name}": method for name, method in found.items()}
