"""The one gate that every motion passes: limits, bodies, controller state, speed override."""

from collections.abc import Callable, Sequence

from catseye.app.engine.alarm import require_no_alarm
from catseye.app.engine.conditions import Condition
from catseye.app.engine.door_watch import DoorWatch
from catseye.app.engine.walked.rule import Desk, WalkRule
from catseye.app.errors import ConditionLostError, InterruptionError, LimitError, SafetyError, UnwalkedError
from catseye.app.store.run_store import RunStore
from catseye.drivers.roles.pose import Axes, Pose, out_of_range
from catseye.drivers.roles.robot import Robot, RobotStatus

# Rounding of a controller that keeps the override as a whole number or as text.
_OVERRIDE_TOLERANCE_PERCENT = 0.01

WayCheck = Callable[[Sequence[Pose]], str | None]
"""Returns why bodies come too near on a way, which begins where the arm stands; None when they do not."""

WHOLE_PERCENT = 1.0
"""What a controller may round an override down by."""

_LEAST_PERCENT = 1.0
"""Controllers take no less."""


def require_in_range(axes: Axes, target: Pose) -> None:
    """Check a target.

    Raises:
        LimitError: an axis is outside its range or not a number; every such axis is named.
    """
    if wrong := out_of_range(axes, target):
        raise LimitError(f"{'; '.join(wrong)}: the robot was not moved; change the plan or the cell's limits")


class MotionGate:
    """Decides about each motion from fresh facts.

    Args:
        blocked: says why bodies are in the way of a motion.
        conditions: of the surroundings that come back by themselves: the air.
        door: of the cell; None where no door is watched.

    Attributes:
        on_override: called with each override that was lowered on request and read back, percent.
        permit: raises when a stop has begun: nothing is sent to the controller then, not even a lower override.
        walk_rule: refuses what was not walked; None where nothing has to be.
    """

    def __init__(
        self,
        robot: Robot,
        axes: Axes,
        blocked: WayCheck,
        override_cap_percent: float,
        conditions: Sequence[Condition] = (),
        door: DoorWatch | None = None,
    ) -> None:
        self._conditions = conditions
        self._door = door
        self._robot = robot
        self._axes = axes
        self._blocked = blocked
        self._cap_percent = override_cap_percent
        self._wanted_percent = override_cap_percent
        self._read_percent = override_cap_percent
        self.on_override: Callable[[float], None] = lambda _percent: None
        self.permit: Callable[[], None] = lambda: None
        self.walk_rule: WalkRule | None = None

    @property
    def override_percent(self) -> float:
        """The override of the next motion, as far as it is known before that."""
        return min(self._wanted_percent, self._read_percent)

    def want_override(self, percent: float) -> float:
        """Lower the override before the next motion, and keep it there; return what it reads until then.

        Raises:
            LimitError: it would not be lowered; nothing changes.
        """
        now = self.override_percent
        if not _LEAST_PERCENT <= percent < now:
            raise LimitError(
                f"the override is {now:g} % (the cell allows {self._cap_percent:g} %) and is only ever lowered from "
                f"here, so {percent:g} % is refused; raise it at the controller, as far as the cell allows"
            )
        self._wanted_percent = percent
        return self._read_percent

    async def lower_override(self) -> float:
        """Bring the override down to the cap, never up; return what the controller reads back.

        Raises:
            SafetyError: the controller does not take it.
        """
        percent = (await self._robot.status()).override_percent
        if percent > self._cap_percent:
            percent = await self._set_override(self._cap_percent)
        self.require_override(percent)
        self._read_percent = percent
        return percent

    async def require(self, *targets: Pose, here: Pose | None = None) -> None:
        """Check that a motion through targets may begin; the controller is looked at afresh for every one.

        Args:
            here: where the arm stands, if that is known; else it is asked.

        Raises:
            LimitError: a target is outside the limits, or a body is in the way there or between the targets.
            UnwalkedError: the motion has to be walked first.
            InterruptionError: the door is open, or the override was raised above the cap.
            ConditionLostError: the air forbids motion now.
            SafetyError: the controller's state forbids motion.
        """
        for target in targets:
            require_in_range(self._axes, target)
        if targets:
            self._require_clear((await self._robot.joints() if here is None else here, *targets))
        await self.require_surroundings()
        status = await self._robot.status()
        require_ready(status)
        require_right(status)
        self.require_override(status.override_percent)
        if self.walk_rule is not None and self.walk_rule.in_force:
            self.walk_rule.require(await self._robot.joints(), targets)
        self._read_percent = status.override_percent
        if self._read_percent > self._wanted_percent:
            await self._lower_to(self._wanted_percent)

    async def waive(self, error: UnwalkedError, desk: Desk, store: RunStore) -> None:
        """Have somebody say why the arm may be driven where it was not walked.

        Raises:
            UnwalkedError: nobody does.
        """
        if self.walk_rule is None:
            raise error
        await self.walk_rule.waive(str(error), desk, store)

    def _require_clear(self, way: Sequence[Pose]) -> None:
        if (blocked := self._blocked(way)) is not None:
            raise LimitError(f"{blocked}; the robot was not moved")

    async def require_surroundings(self) -> None:
        """Check the door as it was seen last, and the air afresh.

        Raises:
            InterruptionError: the door is open or does not answer.
            ConditionLostError: a condition does not hold; the text says which and what to do.
        """
        self.require_door()
        for condition in self._conditions:
            if (trouble := await condition.trouble()) is not None:
                raise ConditionLostError(trouble)

    def require_door(self) -> None:
        """Check the door as it was seen last, at most a tick of the watch ago.

        Raises:
            InterruptionError: it is open or does not answer.
        """
        if self._door is not None and self._door.trouble is not None:
            raise InterruptionError(self._door.trouble)

    def require_override(self, percent: float) -> None:
        """Check an override that the controller reads.

        Raises:
            InterruptionError: it is above the cap: somebody has raised it.
        """
        # Written so that an override that reads NaN is refused too.
        if not percent <= self._cap_percent + _OVERRIDE_TOLERANCE_PERCENT:
            raise InterruptionError(
                f"the controller's override reads {percent:g} % and the cell allows {self._cap_percent:g} %: "
                "no motion; lower it on the controller or check who else sets it"
            )

    async def conditions_hold(self) -> bool:
        """Return whether the air permits motion."""
        return all([await condition.trouble() is None for condition in self._conditions])

    async def _lower_to(self, wanted: float) -> None:
        percent = await self._set_override(wanted)
        if not percent <= wanted + _OVERRIDE_TOLERANCE_PERCENT:
            raise SafetyError(
                f"the controller was asked for an override of {wanted:g} % and reads {percent:g} %: no motion; "
                "lower it at the controller"
            )
        # A controller that rounds up a little is not asked again and again.
        self._wanted_percent = self._read_percent = percent
        self.on_override(percent)

    async def _set_override(self, percent: float) -> float:
        self.permit()
        return await self._robot.set_override(percent)


def require_ready(status: RobotStatus) -> None:
    """Check that a controller may move.

    Raises:
        SafetyError: emergency stop, alarm, teach mode, machine lock or drives off.
    """
    if status.emergency_stop:
        raise SafetyError("the emergency stop is open: release it at the robot, then reset the controller")
    require_no_alarm(status)
    if status.teach_mode:
        raise SafetyError("the controller is in TEACH: turn its key to AUTO")
    if status.machine_locked:
        raise SafetyError(
            "the controller's machine lock is on: it would report motions that the arm does not make; switch it off "
            "at the controller"
        )
    if not status.servo_on:
        raise SafetyError("the drives are off: find out why before switching them on again")


def require_right(status: RobotStatus) -> None:
    """Check that the connection on which motions are sent holds the operation right now.

    Raises:
        SafetyError: it does not: somebody else has taken it, or the key was turned.
    """
    if not status.operation_enabled:
        raise SafetyError(
            "the controller says that this program no longer holds the operation right: nothing was moved; "
            "see who has taken it (panel, pendant, another program), then start again"
        )
