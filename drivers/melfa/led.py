"""What the drivers that lead the arm along ways have in common: everything but motion goes over the R-protocol."""

from drivers.melfa.controller import MelfaController
from drivers.melfa.robot import MelfaR3
from drivers.readings import RobotStatus


class LedArm:
    """Base of a driver that leaves session, drives, override and alarms to the R-protocol.

    Args:
        controller: the R-protocol side.
    """

    def __init__(self, controller: MelfaR3) -> None:
        self._controller = controller

    @property
    def controller(self) -> MelfaController:
        """The controller beyond motion; see MelfaR3.controller."""
        return self._controller.controller

    async def status(self) -> RobotStatus:
        """Return the controller's state; see MelfaR3.status."""
        return await self._controller.status()

    async def servo(self, *, on: bool) -> None:
        """Switch the drives; see MelfaR3.servo."""
        await self._controller.servo(on=on)

    async def set_override(self, percent: float) -> float:
        """Set the operation-panel override; see MelfaR3.set_override."""
        return await self._controller.set_override(percent)

    async def joint_limits(self) -> tuple[tuple[float, float], ...]:
        """Return the controller's own limits; see MelfaR3.joint_limits."""
        return await self._controller.joint_limits()

    async def reset_alarm(self) -> None:
        """Reset the active alarm; see MelfaR3.reset_alarm."""
        await self._controller.reset_alarm()
