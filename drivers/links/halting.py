"""STOP: written past everything on every connection, repeated until the arm is seen to stand."""

import asyncio
from collections.abc import Awaitable, Callable, Coroutine, Sequence
from typing import Any, Final, Protocol

from catseye.drivers.links.cancelling import uninterrupted
from catseye.drivers.links.link import RequestLink
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import DeviceError, LinkError
from catseye.drivers.roles.pose import Pose, is_at

PERIOD_S: Final = 0.1
"""Between two STOPs when one does not get through, real s."""

_STILL_LOOKS: Final = 4
_PRESS: Final = "PRESS THE EMERGENCY STOP if the robot moves"


class Stopper(Protocol):
    """One connection on which an arm is stopped and looked at."""

    @property
    def link(self) -> RequestLink:
        """The connection."""
        ...

    def stop_bytes(self) -> bytes:
        """Return what stops the arm, to be written past whatever waits."""
        ...

    async def stop(self) -> None:
        """Stop the arm, on a connection that is healed for it.

        Raises:
            DeviceError: lost, silent or refused.
        """
        ...

    async def look(self) -> tuple[Pose, bool]:
        """Return where the axes are, and whether the controller says that it moves them.

        Raises:
            DeviceError: lost or silent.
        """
        ...


class StopSettings(Protocol):
    """How a driver confirms a stop."""

    @property
    def stop_timeout_s(self) -> float:
        """For the standstill after STOP, real s."""
        ...

    @property
    def poll_s(self) -> float:
        """Pause between two looks, on the driver's clock."""
        ...


async def stopped_when_cancelled(
    motion: Coroutine[Any, Any, None], stop: Callable[[], Awaitable[None]]
) -> None:
    """Carry out a motion; a cancellation stops the arm before the motion puts its connections in order.

    Args:
        motion: which ends once the arm is stopped; it is cancelled only where the stop fails.
        stop: stops the arm; a cancellation does not interrupt it.

    Raises:
        DeviceError: what the motion raises, or the stop after a cancellation.
    """
    under_way = asyncio.ensure_future(motion)
    try:
        await asyncio.shield(under_way)
    except asyncio.CancelledError:
        try:
            await stop()
        except BaseException:
            under_way.cancel()
            raise
        finally:
            await uninterrupted(_end_of(under_way))
        raise


async def _end_of(motion: asyncio.Future[None]) -> None:
    await asyncio.gather(motion, return_exceptions=True)


class Halt:
    """One stop of a robot.

    Args:
        stoppers: every connection on which STOP is written and the arm is looked at.
        clock: time of the polls.
        still: largest difference between places of a resting arm, deg or mm.
    """

    def __init__(
        self, stoppers: Sequence[Stopper], clock: Clock, settings: StopSettings, *, still: float
    ) -> None:
        self._stoppers = stoppers
        self._clock = clock
        self._settings = settings
        self._still = still
        self._refusals: list[str] = []

    def send(self) -> None:
        """Hand STOP to the operating system on every connection; waits for nothing."""
        for stopper in self._stoppers:
            self._write(stopper)

    async def confirm(self) -> None:
        """Repeat STOP on every connection until one of them sees the arm stand.

        Raises:
            LinkError: nobody says that it stands: use the emergency stop.
        """
        looks = {asyncio.create_task(self._look_until_it_stands(stopper)) for stopper in self._stoppers}
        try:
            done, _ = await asyncio.wait(
                looks, timeout=self._settings.stop_timeout_s, return_when=asyncio.FIRST_COMPLETED
            )
        finally:
            for look in looks:
                look.cancel()
            await asyncio.gather(*looks, return_exceptions=True)
            for stopper in self._stoppers:
                await stopper.link.end_flood()
        if not done:
            raise LinkError(
                f"{self._stoppers[0].link.where}: STOP was written, but the standstill is not confirmed: {_PRESS} "
                f"({(self._refusals or ['the arm moves on'])[-1]})"
            )
        for look in done:
            look.result()

    def _write(self, stopper: Stopper) -> None:
        try:
            stopper.link.send_urgent(stopper.stop_bytes(), cut=b"")
        except LinkError as exc:
            self._refusals.append(str(exc))

    async def _look_until_it_stands(self, stopper: Stopper) -> None:
        """Stop and look on one connection, which is healed for it, until the arm is at rest."""
        while True:
            try:
                await stopper.stop()
                if await self._rests(stopper):
                    return
            except DeviceError as exc:
                self._refusals.append(str(exc))
            await asyncio.sleep(PERIOD_S)
            self._write(stopper)

    async def _rests(self, stopper: Stopper) -> bool:
        """Return whether the controller moves nothing and a few looks see one and the same place."""
        first: Pose | None = None
        for _ in range(_STILL_LOOKS):
            here, busy = await stopper.look()
            if busy or (first is not None and not is_at(first, here, self._still)):
                return False
            first = first or here
            await self._clock.sleep(self._settings.poll_s)
        return True
