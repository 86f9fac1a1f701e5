"""Which bench a run was made on, and whether it is still that one, as far as anybody can know."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Self

from catseye.app.store.device_identity import device_identity

_OF_THE_RUN: Final = ("robot", "interferometer", "tracker")
"""Devices that what a run has found is one with."""

_OF_THE_ARM: Final = ("arm", "expected_model")
"""Keys of [robot] in the cell file."""


@dataclass(frozen=True)
class BenchSeen:
    """What was seen of a bench; nothing of what nobody knows.

    Attributes:
        started: tells one start of an emulated bench from any other.
        simulated: whether the devices were emulators.
        devices: texts that identify a device, by its name.
        arm: as the cell file describes it.
    """

    started: str = ""
    simulated: bool | None = None
    devices: Mapping[str, str] = field(default_factory=dict)
    arm: tuple[Any, ...] | None = None

    def updated(self, later: Self) -> "BenchSeen":
        """Return what is known after something was seen later."""
        return BenchSeen(
            later.started or self.started,
            self.simulated if later.simulated is None else later.simulated,
            {**self.devices, **later.devices},
            later.arm or self.arm,
        )

    def why_no_longer(self, now: Self) -> str:
        """Return why the bench is another one now, in a few words; empty where nothing speaks for that."""
        if why := self.why_another_arm(now):
            return why
        if self.started and now.started and self.started != now.started:
            return "bench restarted since"
        return self._exchanged(now, self.devices)

    def why_another_arm(self, now: Self) -> str:
        """Return why the arm is another one now, whatever measures it; empty where nothing speaks for that."""
        if None not in (self.simulated, now.simulated) and self.simulated != now.simulated:
            return "made in simulation" if self.simulated else "made on the real bench"
        arms = self.arm, now.arm
        other = "another arm in the cell file" if None not in arms and arms[0] != arms[1] else ""
        return self._exchanged(now, ("robot",)) or other

    def _exchanged(self, now: Self, devices: Iterable[str]) -> str:
        known = (name for name in devices if name in self.devices and name in now.devices)
        changed = (name for name in known if self.devices[name] != now.devices[name])
        return next((f"another {name} since" for name in changed), "")


NOTHING_SEEN: Final = BenchSeen()


def seen_by_run(meta: Mapping[str, Any]) -> BenchSeen:
    """Return what a run has seen of its bench; a changed one may have stored anything."""
    configuration, simulated = meta.get("configuration"), meta.get("simulated")
    return BenchSeen(
        str(meta.get("bench_started") or ""),
        simulated if isinstance(simulated, bool) else None,
        {name: text for name in _OF_THE_RUN if (text := device_identity(meta, name))},
        arm_stated(configuration) if isinstance(configuration, Mapping) else None,
    )


def arm_stated(configuration: Mapping[str, Any]) -> tuple[Any, ...] | None:
    """Return the arm of a cell file as plain values; None where it describes none."""
    robot = configuration.get("robot")
    return tuple(robot.get(key) for key in _OF_THE_ARM) if isinstance(robot, Mapping) else None
