"""What keeps a walk going: somebody who gives a sign again and again. It is no enabling device."""

from typing import Final

from catseye.app.errors import CatseyeError
from catseye.drivers.roles.clock import Clock

FED_FOR_S: Final = 0.3
"""How long one feeding lasts, real s."""

_TICK_S = 0.02


class FeedLostError(CatseyeError):
    """Nobody feeds a walk: the arm has been stopped, or was not set going."""


class Feed:
    """Knows whether somebody keeps the arm going.

    Args:
        clock: real time.
        by_itself: emulated devices are walked without anybody.
    """

    def __init__(self, clock: Clock, *, by_itself: bool = False) -> None:
        self.by_itself = by_itself
        self._clock = clock
        self._fed_until_s = -1.0

    @property
    def fed(self) -> bool:
        """The arm may move now."""
        return self.by_itself or self._clock.monotonic_s() < self._fed_until_s

    def feed(self) -> None:
        """Keep the arm going for another 0.3 s."""
        self._fed_until_s = self._clock.monotonic_s() + FED_FOR_S

    def let_go(self) -> None:
        """Stop the arm now."""
        self._fed_until_s = -1.0

    def take(self, on: bool) -> None:
        """Feed, or let go."""
        if on:
            self.feed()
        else:
            self.let_go()

    async def lost(self) -> None:
        """Wait until nobody feeds."""
        while self.fed:
            await self._clock.sleep(_TICK_S)

    async def back(self) -> bool:
        """Return whether somebody feeds."""
        return self.fed
