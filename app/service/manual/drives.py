"""Drives that a run has left on: off after some time of rest, with a countdown that clients see."""

import asyncio
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from datetime import timedelta
from typing import Final, Protocol

from catseye.app.engine.drives import leave_drives
from catseye.app.engine.waiting import cancel
from catseye.app.errors import CatseyeError
from catseye.app.protocol.engine_events import DrivesChanged, DrivesFields
from catseye.app.service.manual.device_loan import Announce, DeviceSource
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import DeviceError

_TICK_S: Final = 0.5
_LIMIT_S: Final = 6.0
"""For the answer of the controller, real s."""


class ManualWork(Protocol):
    """What is done by hand."""

    @property
    def begun(self) -> int:
        """How often something was begun so far."""
        ...

    @property
    def occupied(self) -> str | None:
        """What is under way; None when nothing is."""
        ...


class RestingDrives:
    """Counts down while the arm rests; a jog restarts the count.

    Args:
        clock: real time.
        announce: sends every client an event.
        hands: what is done by hand meanwhile, and is no rest.
        owned: makes this program the arm's owner meanwhile: no drives go off below a motion of another one.

    Attributes:
        facts: for clients that come later; None while no count is under way.
    """

    def __init__(
        self,
        pool: DeviceSource,
        clock: Clock,
        announce: Announce,
        hands: ManualWork,
        owned: Callable[[str], AbstractAsyncContextManager[None]],
    ) -> None:
        self.facts: DrivesFields | None = None
        self._pool = pool
        self._clock = clock
        self._announce = announce
        self._hands = hands
        self._owned = owned
        self._after_s: float | None = None
        self._task: asyncio.Task[None] | None = None
        self._off = False

    def begin(self, after_s: float) -> None:
        """The drives are on and the arm rests: switch them off after some time, real s."""
        self._after_s, self._off = after_s, False
        self._task = asyncio.create_task(self._count(after_s, self._hands.begun))

    def begin_again(self) -> None:
        """The run that was to take the drives over has left them as they were."""
        if self._task is None and self._after_s is not None:
            self.begin(self._after_s)

    def forget(self) -> None:
        """The run has taken the drives over, and has said what became of them."""
        self._after_s = None

    async def cancel(self) -> None:
        """A run takes the drives over."""
        if self._task is not None:
            await cancel(self._task)
            self._task = None
            self.facts = None

    async def end(self) -> None:
        """Switch them off now if they are on: the engine ends, and with it the countdown."""
        # What was tried when the count was over may have failed.
        left_on = self._task is not None and not self._off
        await self.cancel()
        if left_on:
            await self._switch_off("the engine ends")

    async def _count(self, after_s: float, begun: int) -> None:
        end_s = self._announced_end_s(after_s)
        while (left_s := end_s - self._clock.monotonic_s()) > 0.0:
            await self._clock.sleep(min(left_s, _TICK_S))
            # Also what was over within this tick.
            if self._hands.begun != begun:
                while self._hands.occupied is not None:
                    await self._clock.sleep(_TICK_S)
                begun, end_s = self._hands.begun, self._announced_end_s(after_s)
        await self._switch_off(f"the arm has rested for {after_s:g} s")

    def _announced_end_s(self, after_s: float) -> float:
        off_at = self._clock.now_utc() + timedelta(seconds=after_s)
        self.facts = counting = DrivesChanged(on=True, off_at_utc=off_at.isoformat())
        self._announce(counting)
        return self._clock.monotonic_s() + after_s

    async def _switch_off(self, why: str) -> None:
        self.facts = self._after_s = None
        try:
            async with self._pool.acquired_robot("robot") as robot, self._owned("its drives go off"):
                left = await leave_drives(robot, self._clock, _LIMIT_S, keep=False)
        except (CatseyeError, DeviceError) as error:
            self._announce(DrivesChanged(on=True, reason=f"the drives are not certain to be off: {error}"))
            return
        self._off = not left.on
        reason = left.text if left.on else f"{why}: {left.text}"
        self._announce(DrivesChanged(on=left.on, reason=reason))
