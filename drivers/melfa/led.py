"""What the drivers that lead the arm along ways have in common: everything but motion goes over the R-protocol."""

import math
from abc import abstractmethod
from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import asynccontextmanager
from typing import Any

from catseye.drivers.melfa.controller import MelfaController
from catseye.drivers.melfa.jog import Jog
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.device import Examination
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import JogDirection, Robot, RobotStatus


class LedArm(Robot):
    """Base of a driver that leaves session, drives, override and alarms to the R-protocol."""

    def __init__(self, controller: MelfaR3) -> None:
        self._controller = controller

    @property
    def controller(self) -> MelfaController:
        """The controller beyond motion; see MelfaR3.controller."""
        return self._controller.controller

    @abstractmethod
    async def follow(self, way: Sequence[Pose]) -> None:
        """Pass all targets and return when the robot stands at the last one."""

    @abstractmethod
    async def stop(self) -> None:
        """Stop now; the program that leads the arm stands afterwards."""

    @asynccontextmanager
    async def jogging(self, directions: Mapping[str, JogDirection]) -> AsyncIterator[Jog]:
        """Turn joints while what is yielded is fed; see MelfaR3.jogging."""
        if (await self.status()).running:
            # A controller refuses to jog while a program has the arm; it is started again before the next way.
            await self.stop()
        async with self._controller.jogging(directions) as jog:
            yield jog

    async def move_joints(self, target: Pose) -> None:
        """Interpolate all joints to the target; see `follow`."""
        await self.follow((target,))

    async def status(self) -> RobotStatus:
        """Return the controller's state; see MelfaR3.status."""
        return await self._controller.status()

    async def servo(self, *, on: bool) -> None:
        """Switch the drives; see MelfaR3.servo."""
        await self._controller.servo(on=on)

    async def set_override(self, percent: float) -> float:
        """Set the operation-panel override; see MelfaR3.set_override."""
        return await self._controller.set_override(percent)

    async def torques(self) -> tuple[float, ...]:
        """Refuse; see MelfaR3.torques."""
        return await self._controller.torques()

    async def joint_limits(self) -> tuple[tuple[float, float], ...]:
        """Return the controller's own limits; see MelfaR3.joint_limits."""
        return await self._controller.joint_limits()

    async def examine(self) -> Examination:
        """Ask the controller beyond its state; see MelfaR3.examine."""
        return await self._controller.examine()

    @classmethod
    def stop_request(cls, settings: MelfaSettings) -> bytes:
        """Return what stops the arm; see MelfaR3.stop_request."""
        return MelfaR3.stop_request(settings)

    async def reset_alarm(self) -> None:
        """Reset the active alarm; see MelfaR3.reset_alarm."""
        await self._controller.reset_alarm()


def require_way(way: Sequence[Pose]) -> None:
    """Check that a way can be driven.

    Raises:
        ValueError: no target, or a joint is not a finite number.
    """
    if not way or not all(math.isfinite(value) for target in way for value in target):
        raise ValueError(f"a way needs targets that are finite numbers, got {way}")


def parted(settings: Mapping[str, Any], model: type[MelfaSettings]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the settings that go to `MelfaR3.at`, and those that go to a driver's own model."""
    own = model.model_fields.keys() - MelfaSettings.model_fields.keys()
    of_connections = {"stop_endpoint", "status_endpoint", "stop_sink", "guard"}
    return (
        {key: value for key, value in settings.items() if key not in own},
        {key: value for key, value in settings.items() if key not in of_connections},
    )
