"""The instruments of a run: connecting all of them, and letting all of them go."""

import asyncio
from collections.abc import Callable, Coroutine
from dataclasses import asdict, dataclass
from typing import Any

from catseye.app.engine.waiting import cancel
from catseye.app.errors import LinkFailedError, SafetyError, UsageError
from catseye.app.guard.client import ArmGuard
from catseye.drivers.roles.air import AirSensor
from catseye.drivers.roles.device import Device, Entry, Identity
from catseye.drivers.roles.errors import DeviceError
from catseye.drivers.roles.interferometer import Interferometer
from catseye.drivers.roles.io import Io
from catseye.drivers.roles.robot import Robot
from catseye.drivers.roles.tracker import Tracker
from catseye.procedures.kit.records import Json

WireRecorder = Callable[[str, Entry, bytes], None]
"""Takes the device's name, what the entry of the transcript is, and its bytes."""

DeviceBuilder = Callable[[WireRecorder], "Devices"]
"""Makes the devices of a run, unconnected; their transports record into the run's transcript."""


@dataclass(frozen=True)
class Devices:
    """The instruments of a run.

    Attributes:
        robot: the controller.
        interferometer: the length counter, if the cell has one.
        environment: the air sensor, if the cell has one.
        tracker: an independent instrument, if the cell has one.
        io: door interlock and stack light, if the cell has them.
        material: a sensor whose temperature is that of the links, if the cell has one.
        guard: of the robot's arm; None where nobody can own it, which is for tests.
    """

    robot: Robot
    interferometer: Interferometer | None = None
    environment: AirSensor | None = None
    tracker: Tracker | None = None
    io: Io | None = None
    material: AirSensor | None = None
    guard: ArmGuard | None = None

    def named(self) -> dict[str, Device]:
        """Return the instruments by their names in the cell file."""
        fixed: dict[str, Device | None] = {
            "robot": self.robot,
            "interferometer": self.interferometer,
            "environment": self.environment,
            "io": self.io,
            "tracker": self.tracker,
            "material": self.material,
        }
        return {name: device for name, device in fixed.items() if device is not None}


async def connect_all(devices: Devices) -> dict[str, Identity]:
    """Connect all instruments at the same time and return who answered.

    Raises:
        LinkFailedError: some cannot be used; the text lists every one.
    """
    named = devices.named()
    answers = await _at_once([device.connect() for device in named.values()])
    identities: dict[str, Identity] = {}
    failures: dict[str, DeviceError] = {}
    for name, answer in zip(named, answers, strict=True):
        if isinstance(answer, DeviceError):
            failures[name] = answer
        elif isinstance(answer, BaseException):
            raise answer
        else:
            identities[name] = answer
    if failures:
        tree = "\n".join(f"  {name}: {error}" for name, error in failures.items())
        raise LinkFailedError(f"{len(failures)} of {len(named)} devices cannot be used:\n{tree}")
    return identities


async def close_all(devices: Devices) -> dict[str, str]:
    """Disconnect all instruments; return what went wrong, by name."""
    named = devices.named()
    answers = await _at_once([device.close() for device in named.values()])
    return {name: str(answer) for name, answer in zip(named, answers, strict=True) if answer is not None}


def require_permission(identities: dict[str, Identity], cell: str, arm: str | None) -> bool:
    """Check that these devices may be used together and moved; return whether they are emulated.

    Raises:
        UsageError: real hardware and no cell name was typed.
        SafetyError: emulated and real devices are mixed, or another cell's name was typed.
    """
    kinds = {name: identity.simulated for name, identity in identities.items()}
    if all(kinds.values()):
        return True
    if any(kinds.values()):
        emulated = ", ".join(name for name, simulated in kinds.items() if simulated)
        raise SafetyError(
            f"emulated ({emulated}) and real devices are mixed: nothing was moved; check the endpoints of the cell"
        )
    if arm is None:
        raise UsageError(f"the devices are real: type --arm {cell} when the robot may move")
    if arm != cell:
        raise SafetyError(
            f"--arm names {arm!r} and the cell is {cell!r}: nothing was moved; check which robot it is"
        )
    return False


def identities_as_json(identities: dict[str, Identity]) -> dict[str, Json]:
    """Return identities as a run stores them."""
    return {name: asdict(identity) for name, identity in identities.items()}


async def _at_once(actions: list[Coroutine[Any, Any, Any]]) -> list[Any]:
    tasks = [asyncio.create_task(action) for action in actions]
    try:
        return await asyncio.gather(*tasks, return_exceptions=True)
    finally:
        await cancel(*tasks)
