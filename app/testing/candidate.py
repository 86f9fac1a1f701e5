"""The driver that the conformance suite examines, and what may be done with it."""

import json
import re
from collections.abc import Callable, Mapping
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

_CODES: Final = ("utf-8", "utf-16-le")
"""Of the texts that pass a link."""

_SHORTEST_SERIAL: Final = 4

_MARKS: Final = {
    re.compile(re.escape("EMULATOR".encode(code)), re.IGNORECASE): "HARDWARE".encode(code) for code in _CODES
}
"""What emulators call themselves, and a word of the same length in its place."""

Change = Callable[[bytes], bytes]
"""Returns what arrives of a piece that a device says."""


def without_mark(data: bytes) -> bytes:
    """Return what the device would say if it were no emulator."""
    for mark, word in _MARKS.items():
        data = mark.sub(word, data)
    return data


def with_another_serial(data: bytes, serial: str) -> bytes:
    """Return what another device of the same model would say; a short number may be anything and is left alone."""
    if len(serial) < _SHORTEST_SERIAL:
        return data
    other = serial[:-1] + ("0" if serial[-1] != "0" else "1")
    for code in _CODES:
        data = data.replace(serial.encode(code), other.encode(code))
    return data


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
        control: endpoint of the control port of the bench behind `endpoint`; None without one.
        streaming: makes the device send without being asked, as a client that died may have left it; empty: none.
        unmarked: takes the mark of an emulator out of what the device says.
        exchanged: replaces the serial number in what the device says, which is given, by another one.
    """

    name: str
    driver: Any
    role: Role
    endpoint: str | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)
    allow_motion: bool = False
    options: Mapping[str, Option] = field(default_factory=dict)
    arm: str = BUILT_IN_ARMS["scara"]
    control: str | None = None
    streaming: bytes = b""
    unmarked: Change = without_mark
    exchanged: Callable[[bytes, str], bytes] = with_another_serial

    @property
    def emulated(self) -> bool:
        """Whether it talks to the built-in emulator, on a bench of its own for each check."""
        return self.endpoint is None

    @property
    def has_bench(self) -> bool:
        """Whether a control port tells the truth about what is measured."""
        return self.emulated or self.control is not None

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
    control: str | None = None,
    streaming: bytes = b"",
) -> Candidate:
    """Return a driver by its entry point.

    Args:
        name: entry point in the group `catseye.drivers`.
        endpoint: what it is to talk to; None for the built-in emulator.
        allow_motion: a robot behind `endpoint` may be moved.
        arm: of a robot, the name of its description; None for the one that stands on the built-in bench.
        control: endpoint of the control port of the bench behind `endpoint`.
        streaming: makes the device send without being asked.

    Raises:
        LookupError: there is no such driver, no emulator for it, or the class is no driver; the text says what to do.
        ValueError: there is no such arm, or a control port without an endpoint.
    """
    if control is not None and endpoint is None:
        raise ValueError("--control needs --endpoint: the built-in emulator has a control port of its own")
    driver = load_driver(name)
    candidate = Candidate(
        name,
        driver,
        driver.role,
        endpoint,
        dict(settings or {}),
        allow_motion,
        control=control,
        streaming=streaming,
    )
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


def bytes_of(text: str) -> bytes:
    r"""Return the bytes of a text with the escapes of Python, such as `R\r`.

    Raises:
        ValueError: it ends in half an escape, or is no Latin text.
    """
    return text.encode("latin-1").decode("unicode_escape").encode("latin-1")
