"""Parameters (sheet, sections 1.8, 1.14 and 1.16).

A written value is kept and read back. It never acts: on a controller it would act after the power was off and on.
Values without a source (window, masks, the gateway) are this emulator's own.
"""

import re

from catseye.simulators.config import EmulationConfig
from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal

_NAME = re.compile(r"[A-Z][A-Z0-9]{0,15}")
_OPTIONS = range(11, 20)
"""OPT11 to OPT19, the TCP lines."""


class Parameters:
    """Values by name, as text.

    Args:
        config: limits and rest position.
    """

    def __init__(self, config: EmulationConfig) -> None:
        self._values = {**_robot(config), **_ethernet()}
        self.changed: list[str] = []

    def read(self, name: str) -> str:
        """Return `name;values;count`.

        Raises:
            Refusal: there is no such parameter.
        """
        values = self._find(name.strip().upper())
        return f"{name.strip().upper()};{', '.join(values)};{len(values)}"

    def write(self, name: str, text: str) -> None:
        """Keep new values, as many as there were.

        Raises:
            Refusal: there is no such parameter, or the number of values differs.
        """
        key = name.strip().upper()
        values = [part.strip() for part in text.split(",")]
        if len(values) != len(self._find(key)) or not all(values):
            raise Refusal(alarms.OUT_OF_RANGE)
        self._values[key] = values
        if key not in self.changed:
            self.changed.append(key)

    def preset(self, name: str, values: list[str]) -> None:
        """Have a parameter say what a program of the controller goes by; nobody has changed it."""
        self._values[name] = values

    def _find(self, name: str) -> list[str]:
        if _NAME.fullmatch(name) is None or name not in self._values:
            raise Refusal(alarms.OUT_OF_RANGE)
        return self._values[name]


def _robot(config: EmulationConfig) -> dict[str, list[str]]:
    limits = [bound for axis in config.limits for bound in axis]
    return {
        "RLNG": ["1"],
        "MEJAR": _numbers([*limits, *[0.0] * 8]),
        "MEPAR": _numbers([-10_000.0, 10_000.0] * 3),
        "JSAFE": _numbers([*config.start_joints, *[0.0] * 4]),
        "MEXTL": _numbers([0.0] * 6),
        "MEXBS": _numbers([0.0] * 6),
        "TASKMAX": ["8"],
    }


def _ethernet() -> dict[str, list[str]]:
    return {
        "NETIP": ["192.168.0.20"],
        "NETMSK": ["255.255.255.0"],
        "NETGW": ["192.168.0.254"],
        "NETPORT": [str(port) for port in range(10_000, 10_010)],
        **{f"CPRCE{option}": ["0"] for option in _OPTIONS},
        "NETMODE": ["1"] * len(_OPTIONS),
        "NETHSTIP": ["192.168.0.2"] * len(_OPTIONS),
        "COMDEV": ["RS232", *[f"OPT{option}" for option in range(11, 18)]],
        "NETTERM": ["0"],
        "CTERME": ["0"],
        "NETTOUTR": ["-1"],
        "NETTOUTS": ["-1"],
        "MXTCOM1": ["192.168.0.2"],
        "MXTCOM2": ["192.168.0.3"],
        "MXTCOM3": ["192.168.0.4"],
        "MXTTOUT": ["-1"],
    }


def _numbers(values: list[float]) -> list[str]:
    return [f"{value:.2f}" for value in values]
