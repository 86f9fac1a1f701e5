"""One motion of an arm: what it may write, and how it ends when something fails."""

import contextlib
from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from catseye.drivers.links.guarding import LinkGuard
from catseye.drivers.links.stops import StopWatch
from catseye.drivers.roles.errors import DeviceError


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

    async def stop_after_failure(self) -> None:
        """Stop an arm of which it is not known what it does; the failure itself is what is reported.

        Raises:
            RefusedError: a stop is the reason of the failure.
            GuardError: the guard's stop is.
        """
        self.require_no_stop()
        try:
            self.guard.permit()
        finally:
            with contextlib.suppress(DeviceError):
                await self.stop()
