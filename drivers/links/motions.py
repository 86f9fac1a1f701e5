"""One motion of an arm: what it may write, how long it goes on unseen, and how it ends when something fails."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Final, TypeVar

from catseye.drivers.links.guarding import GuardError, LinkGuard
from catseye.drivers.links.stops import StopWatch
from catseye.drivers.roles.errors import DeviceError, LinkTimeoutError

T = TypeVar("T")

HEALING_S: Final = 1.0
"""Beyond one answer that is lost, for its connection to be healed and asked again while an arm may move, real s."""


async def seen_in_time(look: Awaitable[T], answer_timeout_s: float, where: str) -> T:
    """Return what a look at an arm that may be moving sees; its connection is not healed for longer.

    Args:
        answer_timeout_s: for one answer, real s.
        where: robot and endpoint, for the text.

    Raises:
        LinkTimeoutError: nothing was seen within that and `HEALING_S`.
        DeviceError: what the look raises.
    """
    unseen_s = answer_timeout_s + HEALING_S
    try:
        async with asyncio.timeout(unseen_s):
            return await look
    except TimeoutError:
        raise LinkTimeoutError(
            f"{where}: nothing was seen of a motion for {unseen_s:g} s (answer_timeout_s and {HEALING_S:g} s), so "
            "it is stopped: check the network, the controller's power, and that it is not overloaded"
        ) from None


@dataclass(frozen=True)
class Motion:
    """A motion that may be under way.

    Attributes:
        watch: knows the stops since it began.
        guard: of the arm.
        stop: stops the arm and confirms that it stands.
    """

    watch: StopWatch
    guard: LinkGuard
    stop: Callable[[], Awaitable[None]]

    def permit(self) -> None:
        """Check that something may be written that lets the arm move.

        Raises:
            RefusedError: a stop has overtaken the motion.
            GuardError: the guard does not permit it.
        """
        self.require_no_stop()
        self.guard.permit()

    def require_no_stop(self) -> None:
        """Check that the motion goes on.

        Raises:
            RefusedError: a stop has overtaken it.
        """
        self.watch.require_none()

    async def stop_after(self, failure: Exception) -> None:
        """Stop an arm of which it is not known what it does; the failure is what is reported.

        A stop that is not confirmed is noted on it.

        Raises:
            RefusedError: a stop is the reason of the failure.
            GuardError: the guard's stop is.
        """
        self.require_no_stop()
        try:
            self.guard.permit()
        except GuardError as exc:
            await self._stop_beside(exc)
            raise
        await self._stop_beside(failure)

    async def _stop_beside(self, failure: Exception) -> None:
        try:
            await self.stop()
        except DeviceError as exc:
            failure.add_note(str(exc))
