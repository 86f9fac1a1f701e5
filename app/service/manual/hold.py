"""Keeping one joint moving while somebody feeds: the arm stops when the feed, the room or the permission ends."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Final

from catseye.app.engine.waiting import cancel
from catseye.app.errors import LimitError
from catseye.app.service.manual.approach import MARGIN, Approach
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.pose import Axis, Pose, with_axis
from catseye.drivers.roles.robot import JogFeed, Robot

FED_FOR_S: Final = 0.2
"""How long one feeding lasts, real s."""

_TICK_S = 0.02
_PERMISSION_S = 0.2
"""Between two looks at door and controller."""


@dataclass(frozen=True)
class Sight:
    """What a hold sees of arm and surroundings.

    Attributes:
        joints: asks for the joints.
        require_permission: raises when door or controller forbid to go on.
    """

    joints: Callable[[], Awaitable[Pose]]
    require_permission: Callable[[], Awaitable[None]]


class Hold:
    """One joint, moving one way until it is released.

    Args:
        number: of the axis in a pose, from 0.
        approach: to the cell's limit.
        clock: real time.

    Attributes:
        joint: name of what moves, in lower case.
        direction: which way.
        reason: why it is over; empty while it goes on.
        on_begun: is called when the joint has been set going.
    """

    def __init__(
        self, robot: Robot, axis: Axis, number: int, approach: Approach, sight: Sight, clock: Clock
    ) -> None:
        self.joint = axis.name.lower()
        self.direction = approach.direction
        self.reason = ""
        self.on_begun: Callable[[], None] = lambda: None
        self._axis = axis
        self._number = number
        self._robot = robot
        self._approach = approach
        self._sight = sight
        self._clock = clock
        self._over = asyncio.Event()
        self._feed: JogFeed | None = None
        self._fed_until_s = clock.monotonic_s() + FED_FOR_S
        self._free_until_s = 0.0
        self._obstacle = ""

    def feed(self) -> None:
        """Keep moving for another 0.2 s."""
        self._fed_until_s = self._clock.monotonic_s() + FED_FOR_S
        if self._feed is not None and not self.reason:
            self._feed.feed()

    def release(self, reason: str) -> None:
        """Stop now; the first reason counts."""
        self.reason = self.reason or reason
        self._over.set()

    def at_limit(self, here: Pose) -> Pose:
        """Return the joints as they would be with this one at the limit that it is on its way to."""
        return with_axis(here, self._number, self._limit)

    def end_at(self, end: Pose, obstacle: str | None) -> None:
        """Take what stands in the way before the limit for the limit.

        Args:
            end: joints up to which the way is clear.
            obstacle: what is in the way beyond; None when nothing is.
        """
        if obstacle is not None:
            self._obstacle = f": {obstacle}"
            self._approach.shorten(end[self._number])

    async def require_room(self) -> None:
        """Check that the joint, which stands, may be set going.

        Raises:
            LimitError: its limit is too near.
        """
        await self._see()
        if self._free_until_s <= self._clock.monotonic_s():
            raise LimitError(self._too_near)

    async def move(self) -> None:
        """Move until released; the arm stands when this returns.

        Raises:
            DeviceError: the robot refuses, or does not answer any more.
            CatseyeError: door or controller forbid to go on.
        """
        self._release_if_due()
        if self.reason:
            return
        looks, timer = asyncio.create_task(self._look()), asyncio.create_task(self._time())
        # A look ends early by an error only.
        looks.add_done_callback(lambda _: self._over.set())
        try:
            async with self._robot.jogging({self._axis.name: self.direction}) as self._feed:
                self._feed.feed()
                self.on_begun()
                await self._over.wait()
        except asyncio.CancelledError:
            looks.cancel()
            raise
        finally:
            self._feed = None
            self.release("the robot ended it")
            await cancel(timer)
            # A question on its way is let come to its answer: the link stays in step.
            await asyncio.gather(looks, return_exceptions=True)
        looks.result()

    async def _look(self) -> None:
        """Look at the joint, and now and then around, until it is over."""
        permitted_s = self._clock.monotonic_s()
        while not self.reason:
            await self._see()
            if self._clock.monotonic_s() - permitted_s >= _PERMISSION_S:
                permitted_s = self._clock.monotonic_s()
                await self._sight.require_permission()
            await self._clock.sleep(_TICK_S)

    async def _see(self) -> None:
        asked_s = self._clock.monotonic_s()
        joints = await self._sight.joints()
        # Reckoned from the question: the joint has gone on since the answer was made up.
        self._free_until_s = asked_s + self._approach.free_s(asked_s, joints[self._number])

    async def _time(self) -> None:
        """Release when the feed or the room ends, however long a look takes."""
        while not self.reason:
            await self._clock.sleep(_TICK_S)
            self._release_if_due()

    def _release_if_due(self) -> None:
        now_s = self._clock.monotonic_s()
        if now_s >= self._fed_until_s:
            self.release("it was not fed any more")
        elif now_s >= self._free_until_s:
            self.release(self._too_near)

    @property
    def _limit(self) -> float:
        low, high = self._approach.limits
        return high if self.direction > 0 else low

    @property
    def _too_near(self) -> str:
        return (
            f"{self._axis.name} is too near to its limit of {self._limit:g} {self._axis.unit} to be stopped with "
            f"{MARGIN:g} {self._axis.unit} to spare: go on by steps{self._obstacle}"
        )
