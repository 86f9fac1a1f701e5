"""What has to hold around the robot while it moves and comes back by itself, the air; and who looks at the bench."""

import logging
from collections.abc import Callable, Sequence
from typing import Protocol

from catseye.app.cell.model import Conditions
from catseye.app.engine.control import RunControl
from catseye.app.engine.measuring import AirCache
from catseye.app.errors import InterruptionError, SafetyError
from catseye.app.protocol.state import RUNNING, ControlState
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import DeviceError
from catseye.drivers.roles.robot import Robot, RobotStatus
from catseye.procedures.kit.live import in_band

_log = logging.getLogger(__name__)

_IDLE_SHARE = 20.0
"""While nothing moves looks take at most a twentieth of the time."""

_LONGEST_S = 10.0
"""A look that a motion has delayed puts off the next one by no more, s of the clock."""

_MOTION_LOOKS = 2.5
"""While the arm moves there are so many times as many looks."""

_UNITS = {"temperature_c": "°C", "pressure_hpa": "hPa", "humidity_percent": "%RH"}


class Condition(Protocol):
    """Something that has to hold while the robot moves."""

    async def trouble(self) -> str | None:
        """Return what is wrong and what to do about it; None when the condition holds."""
        ...


class AirInRange:
    """The air is as the cell demands; a quantity that the sensor does not give is not judged here."""

    def __init__(self, air: AirCache, limits: Conditions) -> None:
        self._air = air
        self._limits = limits

    async def trouble(self) -> str | None:
        """Return which quantity is out of its range."""
        sample = await self._air.get()
        for name, (low, high) in self._limits.ranges.items():
            value: float | None = getattr(sample, name)
            if value is not None and not in_band(value, low, high):
                quantity, unit = name.rpartition("_")[0], _UNITS[name]
                return (
                    f"the air's {quantity} is {value:.2f} {unit}, outside {low:g} … {high:g} {unit} of [conditions]: "
                    "check the air conditioning or the sensor; the run continues by itself when it is back"
                )
        return None


class Watchman:
    """Looks at the controller all the time, at the air while nothing moves, also during questions and holds.

    A controller that answers late delays nothing but this: the door has a watch of its own.

    Args:
        ready: raises when a controller in this state may not move: InterruptionError if somebody who acknowledges
            that is enough to go on.
        poll_s: between two looks while nothing moves, s of the clock.
    """

    def __init__(
        self,
        control: RunControl,
        robot: Robot,
        conditions: Sequence[Condition],
        ready: Callable[[RobotStatus], None],
        clock: Clock,
        poll_s: float,
    ) -> None:
        self._control = control
        self._robot = robot
        self._conditions = conditions
        self._ready = ready
        self._clock = clock
        self._poll_s = poll_s
        self._suspended_for: str | None = None
        self._silent = False

    async def watch(self) -> None:
        """Look until cancelled."""
        due_s = self._clock.monotonic_s() + self._poll_s
        while True:
            await self._clock.sleep(self._poll_s / _MOTION_LOOKS)
            start_s = self._clock.monotonic_s()
            if not self._may_judge or (start_s < due_s and not self._control.moving):
                continue
            try:
                await self._look()
                self._silent = False
            except DeviceError as error:
                # The next command to that device finds out what it means; here it only could not be looked at.
                if not self._silent:
                    self._silent = True
                    _log.warning("the surroundings cannot be watched: %s", error)
            # On a slow serial line a look takes a tenth of a second, which a measurement waits for.
            end_s = self._clock.monotonic_s()
            due_s = end_s + max(self._poll_s, min(_IDLE_SHARE * (end_s - start_s), _LONGEST_S))

    @property
    def _may_judge(self) -> bool:
        """The run goes on, and the robot is not just being brought to rest: that is looked at by itself."""
        return self._control.state in RUNNING - {ControlState.SUSPENDING}

    async def _look(self) -> None:
        status = await self._robot.status()
        if not self._may_judge:
            return
        try:
            self._ready(status)
        except InterruptionError as error:
            self._control.interrupt(str(error))
        except SafetyError as error:
            self._control.abort(error)
        else:
            if not self._control.moving:
                await self._look_around()

    async def _look_around(self) -> None:
        troubles, unseen = await self._troubles()
        if troubles and self._control.state == ControlState.EXECUTE:
            self._suspended_for = troubles[0]
            self._control.suspend(troubles[0])
        elif not troubles and unseen is None and self._suspended_for is not None:
            reason, self._suspended_for = self._suspended_for, None
            if self._control.state == ControlState.SUSPENDED:
                self._control.condition_back(f"over: {reason}")
        if unseen is not None:
            raise unseen

    async def _troubles(self) -> tuple[list[str], DeviceError | None]:
        """Return what is wrong, and why one of the conditions could not be looked at: it hides no other."""
        found: list[str] = []
        unseen: DeviceError | None = None
        for condition in self._conditions:
            try:
                text = await condition.trouble()
            except DeviceError as error:
                unseen = error
                continue
            if text is not None:
                found.append(text)
        return found, unseen
