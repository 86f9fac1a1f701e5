"""Nothing waits for ever: a run that nobody could let go on ends by itself."""

from collections.abc import Callable
from typing import Final

from catseye.app.engine.control import RunControl
from catseye.drivers.roles.clock import Clock

_LOOKS: Final = 4
"""At least so often within the limit somebody looks whether anybody is there."""


class HoldLimit:
    """Ends a run as stopped that has waited for too long while nobody with control was there.

    Args:
        attended: a client has control, or somebody is at the terminal of the run.
        limit_s: real s; of every wait without a break, from when it begins or the last one who was there goes.
        speed: seconds of the clock in one real second.
        poll_s: between two looks, real s.
    """

    def __init__(
        self,
        control: RunControl,
        clock: Clock,
        attended: Callable[[], bool],
        limit_s: float,
        speed: float,
        poll_s: float,
    ) -> None:
        self._control = control
        self._clock = clock
        self._attended = attended
        self._limit_s = limit_s
        self._speed = speed
        self._poll_s = min(poll_s, limit_s / _LOOKS)

    async def watch(self) -> None:
        """Look until cancelled."""
        attended_s = self._clock.monotonic_s()
        while True:
            await self._clock.sleep(self._poll_s * self._speed)
            now_s, since_s = self._clock.monotonic_s(), self._control.wait_time.since_s
            if self._attended():
                attended_s = now_s
            if since_s is None or self._control.ending is not None:
                continue
            if now_s - max(since_s, attended_s) >= self._limit_s * self._speed:
                self._control.give_up(
                    f"{self._control.wait_time.reason}, and nobody was there to let it go on for {self._limit_s:g} s "
                    "([engine] hold_limit_s)"
                )
