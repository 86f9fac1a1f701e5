"""Which stops have begun and ended: what one of them overtakes must not begin."""

from collections.abc import Iterator
from contextlib import contextmanager

from catseye.drivers.roles.errors import RefusedError


class Stops:
    """Counts the stops of one robot.

    Attributes:
        begun: so many have begun.
        ended: so many are over.
    """

    def __init__(self) -> None:
        self.begun = 0
        self.ended = 0

    @contextmanager
    def one(self) -> Iterator[None]:
        """Count a stop that is under way meanwhile."""
        self.begun += 1
        try:
            yield
        finally:
            self.ended += 1


class StopWatch:
    """Knows whether a stop is under way, or has begun since this was made.

    Args:
        where: robot and endpoint, for the text.
        number: the controller's own error number of a motion that a stop has ended; 0 where it has none.
    """

    def __init__(self, stops: Stops, where: str, number: int = 0) -> None:
        self._stops = stops
        self._where = where
        self._number = number
        self._ended = stops.ended

    @property
    def seen(self) -> bool:
        """A stop is under way or has begun."""
        return self._stops.begun > self._ended

    def require_none(self) -> None:
        """Check that a motion may begin or go on.

        Raises:
            RefusedError: a stop has overtaken it.
        """
        if self.seen:
            raise RefusedError(f"{self._where}: a stop overtook the motion: it does not go on", self._number)
