"""The driver that the conformance suite examines, and what may be done with it."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final

from catseye.app.cell.arm import shipped_arm
from catseye.drivers.roles.device import Role
from catseye.drivers.roles.registry import load_driver
from catseye.simulators.config import Option
from catseye.simulators.emulator import emulator_names, load_emulator

_LEAST_PATIENCE_S, _MOST_PATIENCE_S = 5.0, 40.0
_SLOW = ("move", "start", "servo", "stop")
"""Beginnings of the names of time-outs that are no question's."""


BUILT_IN_ARMS: Final = {"scara": "rh-3frh5515", "serial": "kr210-r2700"}
"""Descriptions of the arms on the built-in benches, by what emulators of robots call them."""


@dataclass(frozen=True)
class Candidate:
    """A driver to be examined.

    Attributes:
        name: its entry point in `catseye.drivers`.
        driver: the class.
        role: what it is a driver of.
        endpoint: what it is to talk to; None for the built-in emulator of the same name.
        settings: as in a cell file.
        allow_motion: a robot behind `endpoint` may be moved.
        options: of the built-in emulator, beyond the settings.
        arm: of a robot's, the name of its description.
    """

    name: str
    driver: Any
    role: Role
    endpoint: str | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)
    allow_motion: bool = False
    options: Mapping[str, Option] = field(default_factory=dict)
    arm: str = BUILT_IN_ARMS["scara"]

    @property
    def emulated(self) -> bool:
        """Whether it talks to our emulator, with its control port."""
        return self.endpoint is None

    @property
    def may_move(self) -> bool:
        """Whether motion may be commanded."""
        return self.emulated or self.allow_motion

    @property
    def has_proxy(self) -> bool:
        """Whether faults of the link can be made, which takes a TCP link."""
        return self.endpoint is None or self.endpoint.startswith("tcp://")

    @property
    def doors(self) -> dict[str, str]:
        """Emulated protocols by the names of the endpoints that `at` takes."""
        declared = self.driver.protocols
        return {"endpoint": self.name} if declared is None else dict(declared)

    @property
    def patience_s(self) -> float:
        """How long a question may take at most: a few times the longest time-out of the settings."""
        fields = self.driver.Settings.model_fields
        times = [
            self.settings.get(name, info.default)
            for name, info in fields.items()
            if name.endswith("timeout_s") and not name.startswith(_SLOW)
        ]
        longest_s = max((float(t) for t in times if isinstance(t, int | float)), default=0.0)
        return min(_MOST_PATIENCE_S, max(_LEAST_PATIENCE_S, 4.0 * longest_s))


def candidate_of(
    name: str,
    *,
    endpoint: str | None = None,
    settings: Mapping[str, Any] | None = None,
    allow_motion: bool = False,
    arm: str | None = None,
) -> Candidate:
    """Return a driver by its entry point.

    Args:
        name: entry point in the group `catseye.drivers`.
        endpoint: what it is to talk to; None for the built-in emulator.
        allow_motion: a robot behind `endpoint` may be moved.
        arm: of a robot, the name of its description; None for the one that stands on the built-in bench.

    Raises:
        LookupError: there is no such driver, no emulator for it, or the class is no driver; the text says what to do.
        ValueError: there is no such arm.
    """
    driver = load_driver(name)
    candidate = Candidate(name, driver, driver.role, endpoint, dict(settings or {}), allow_motion)
    if candidate.emulated and not set(candidate.doors.values()) <= set(emulator_names()):
        raise LookupError(
            f"there is no emulator for {name}: give --endpoint URL of the device or of an emulator"
        )
    emulated = [load_emulator(door).arm for door in candidate.doors.values() if door in emulator_names()]
    named = arm or BUILT_IN_ARMS[emulated[0] if emulated else "scara"]
    shipped_arm(named)
    return replace(candidate, arm=named)


def parse_setting(text: str) -> tuple[str, Any]:
    """Read `key=value`; the value is JSON, or text when it is none.

    Raises:
        ValueError: there is no `=`.
    """
    key, equals, value = text.partition("=")
    if not equals:
        raise ValueError(f"--setting {text}: write key=value, such as --setting timeout_s=0.5")
    try:
        return key, json.loads(value)
    except ValueError:
        return key, value
