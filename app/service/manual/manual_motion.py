"""One motion by hand: under the same stop ladder as those of a run, with a control of its own."""

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from typing import Any

from catseye.app.engine.control import RunControl
from catseye.app.engine.ending import DeviceFaultError, react
from catseye.app.engine.halt import HaltLimits
from catseye.app.engine.waiting import cancel
from catseye.app.errors import SafetyError
from catseye.app.protocol.state import ControlState
from catseye.app.service.manual.hold import Hold
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.robot import Robot

Watch = Callable[[], Awaitable[None]]
"""Goes on until the motion ends; what it raises breaks the motion off."""


class ManualMotion:
    """A step, or a joint that is kept moving.

    Args:
        clock: real time.
        limits: how long a halt may take.
        hold: the feed; None for a step.

    Attributes:
        joint: what moves.
        hold: the feed; None for a step.
        began: the robot was told to move.
    """

    def __init__(
        self, joint: str, robot: Robot, clock: Clock, limits: HaltLimits, hold: Hold | None = None
    ) -> None:
        self.joint = joint
        self.hold = hold
        self.began = False
        self._over = False
        self._control = RunControl(clock, _ignore, limits)
        self._control.attach(robot)
        self._control.starting()
        self._control.started()

    @property
    def unconfirmed(self) -> str:
        """Why the standstill is not certain; empty when the arm stands."""
        return next((report.text for report in self._control.reports if not report.standstill), "")

    def require_unstopped(self) -> None:
        """Check that nobody has stopped it.

        Raises:
            CatseyeError: why it was ended.
        """
        self._control.raise_ending()

    def stop(self, reason: str) -> None:
        """Stop the robot now, past everything under way; again does no harm."""
        self._control.stop(reason)

    def break_off(self, error: Exception) -> None:
        """Stop the robot now since something failed."""
        if self._control.ending is None:
            react(self._control, error)

    async def carry_out(
        self, gate: Callable[[], Coroutine[Any, Any, None]], action: Watch, *watches: Watch
    ) -> None:
        """Move; the arm stands when this returns, or raises.

        Args:
            watches: go on meanwhile.

        Raises:
            Exception: why it did not begin, or was ended.
        """

        async def begin() -> None:
            self.began = True
            await action()

        guards = [asyncio.create_task(self._guard(watch)) for watch in watches]
        try:
            await self._control.motion(gate, begin)
        except Exception as error:
            if self.began:
                self.break_off(error)
            await self._control.halted()
            cause = self._cause(error)
            if cause is error:
                raise
            raise cause from error
        finally:
            self._over = True
            await cancel(*guards)

    def _cause(self, error: Exception) -> BaseException:
        """Return why the motion ended: the first thing that broke it off, not what followed from that."""
        ending = self._control.ending
        if isinstance(ending, DeviceFaultError):
            return ending.__cause__ or ending
        return ending or error

    async def _guard(self, watch: Watch) -> None:
        try:
            await watch()
        except asyncio.CancelledError:
            if not self._over:
                self.break_off(SafetyError(f"the motion of {self.joint} is watched no more: it was stopped"))
            raise
        except Exception as error:  # noqa: BLE001  # whatever fails that watches, the arm must not go on unwatched
            self.break_off(error)


def _ignore(_state: ControlState, _reason: str) -> None:
    """Clients see what moves, not the states of each motion."""
