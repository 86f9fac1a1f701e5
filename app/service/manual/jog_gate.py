"""The gate of motions by hand: the one of a run, with limits and words for whoever jogs."""

from collections.abc import Callable

from catseye.app.engine.devices import Devices
from catseye.app.engine.door_watch import DoorWatch
from catseye.app.engine.gate import MotionGate, require_ready
from catseye.app.service.watching.bench_facts import BenchFacts
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.motion.clear_way import clear_part, way_check


class JogGate:
    """Decides about each motion by hand from fresh facts.

    Args:
        percent: speed override that is asked for.
        door: of the cell; None where no door is watched.

    Attributes:
        percent: speed override, at most what the cell allows.
        axes: of the arm, with the ranges within which it is moved by hand.
    """

    def __init__(
        self, devices: Devices, facts: BenchFacts, percent: float, door: DoorWatch | None = None
    ) -> None:
        self.percent = min(percent, facts.override_cap_percent)
        self.axes = facts.system.manual_axes
        self._robot = devices.robot
        self._bench = facts.bench
        self._gate = MotionGate(devices.robot, self.axes, way_check(facts.bench), self.percent, door=door)

    @property
    def override_percent(self) -> float:
        """The override as it was read last: at most `percent`, less where the controller's is lower."""
        return self._gate.override_percent

    def belong_to(self, permit: Callable[[], None]) -> None:
        """Ask a motion from now on whether the override may still be lowered; it raises once it was stopped."""
        self._gate.permit = permit

    async def switch_on(self) -> float:
        """Bring the override down and the drives on; return the override that is read back.

        Raises:
            SafetyError: door, alarm, emergency stop or key forbid it, or the override does not come down.
        """
        self._gate.require_door()
        percent = await self._gate.lower_override()
        await self._robot.servo(on=True)
        require_ready(await self._robot.status())
        return percent

    def clear_part(self, here: Pose, target: Pose) -> tuple[Pose, str | None]:
        """Return how far the arm may go straight towards a target, and what is in its way then."""
        return clear_part(here, target, self._bench)

    async def require(self, *targets: Pose, here: Pose) -> None:
        """Check that a motion may begin; an override that somebody raised is lowered again, and read back.

        Raises:
            LimitError: a target is outside the limits, or a body is in the way.
            SafetyError: door, controller or override forbid it.
        """
        await self._gate.lower_override()
        await self._gate.require(*targets, here=here)

    async def require_permission(self) -> None:
        """Check that a motion may go on: door, controller, override.

        Raises:
            SafetyError: it may not.
        """
        await self._gate.require()
