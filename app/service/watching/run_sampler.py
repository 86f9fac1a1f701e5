"""Light looks at the devices of a run for whoever watches, while the run itself wants nothing of them."""

import asyncio
import logging
from collections.abc import Coroutine
from typing import Any

from catseye.app.engine.control import RunControl
from catseye.app.engine.devices import Devices
from catseye.app.protocol.state import ControlState
from catseye.app.service.watching.latest_values import LatestValues, Stamped
from catseye.app.service.watching.observed_devices import ObservedDevice
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import DeviceError
from catseye.drivers.roles.interferometer import Interferometer
from catseye.drivers.roles.robot import Robot

_log = logging.getLogger(__name__)

BEAM_AGE_S = 0.25
"""A state of the beam that is younger is good enough to be shown."""

ROBOT_AGE_S = 1.0

_PAUSE_SHARE = 20.0
"""Looks take at most a twentieth of a link's time: a slow line is left to the run."""


class RunSampler:
    """Asks for the beam while the arm moves, a question is open or the run is held; for the robot while it stands.

    Nothing is asked during a dwell, on a link that the run is using, or of the robot while it moves: neither a
    reading nor a STOP waits for a look. A look that is under way when the run goes on is not cut off, since the link
    would have to be healed then.

    Args:
        clock: real time.

    Attributes:
        devices: of the run; None before there is one.
    """

    def __init__(self, latest: LatestValues, clock: Clock) -> None:
        self.devices: Devices | None = None
        self._latest = latest
        self._clock = clock
        self._looks: dict[str, asyncio.Task[None]] = {}
        self._due_s: dict[str, float] = {}

    def tick(self, control: RunControl, *, asking: bool) -> None:
        """Begin the looks that are due and permitted."""
        if self.devices is None:
            return
        stands = not control.moving and (asking or control.state == ControlState.HELD)
        if (stands or control.moving) and self.devices.interferometer is not None:
            self._look_at_counter(self.devices.interferometer)
        if stands:
            self._look_at_robot(self.devices.robot)

    def _look_at_robot(self, robot: Robot) -> None:
        if self._is_old(self._latest.joints, ROBOT_AGE_S):
            self._look("robot", robot, self._look_at_joints(robot))
        elif self._is_old(self._latest.status, ROBOT_AGE_S):
            # A question before the first motion waits while nothing else asks for alarm, drives and override.
            self._look("robot", robot, self._look_at_status(robot))

    def _look_at_counter(self, counter: Interferometer) -> None:
        if self._is_old(self._latest.beam, BEAM_AGE_S):
            self._look("beam", counter, self._look_at_beam(counter))
        elif self._is_old(self._latest.displacement_mm, BEAM_AGE_S):
            # A question that watches the signal asks for the state alone.
            self._look("beam", counter, self._look_at_length(counter))

    def _is_old(self, value: Stamped[object] | None, limit_s: float) -> bool:
        return value is None or self._latest.age_s(value.time_s) >= limit_s

    def _look(self, what: str, device: object, look: Coroutine[Any, Any, None]) -> None:
        """Begin a look unless the link is in use or has had enough of them."""
        busy = isinstance(device, ObservedDevice) and device.busy
        under_way = what in self._looks and not self._looks[what].done()
        if busy or under_way or self._clock.monotonic_s() < self._due_s.get(what, 0.0):
            look.close()
            return
        self._looks[what] = asyncio.create_task(self._bounded_share(what, look))

    async def _bounded_share(self, what: str, look: Coroutine[Any, Any, None]) -> None:
        start_s = self._clock.monotonic_s()
        try:
            await look
        except DeviceError:
            # The latest values show it; the run finds it out by itself when it needs the device.
            pass
        except Exception:  # noqa: BLE001  # a fault of a driver must not end the watching
            _log.exception("a look at the %s failed", what)
        now_s = self._clock.monotonic_s()
        self._due_s[what] = now_s + _PAUSE_SHARE * (now_s - start_s)

    async def _look_at_beam(self, counter: Interferometer) -> None:
        await counter.status()
        await counter.read()

    async def _look_at_length(self, counter: Interferometer) -> None:
        await counter.read()

    async def _look_at_joints(self, robot: Robot) -> None:
        await robot.joints()

    async def _look_at_status(self, robot: Robot) -> None:
        await robot.status()
