"""A guard of an arm that keeps what a driver hands over, and says STOP when a test wants it."""

import os

from catseye.drivers.links.guarding import Unguarded


class RecordingGuard(Unguarded):
    """Keeps duplicates of connections as the guard's process does.

    Attributes:
        taken: how often it was handed one, for the first time or anew.
    """

    def __init__(self) -> None:
        self.taken = 0
        self._links: dict[str, tuple[int, bytes]] = {}

    @property
    def names(self) -> set[str]:
        """Of the connections that are protected."""
        return set(self._links)

    def protect(self, name: str, descriptor: int, stop: bytes) -> None:
        """Take a duplicate."""
        self._forget(name)
        self.taken += 1
        self._links[name] = (os.dup(descriptor), stop)

    async def release(self, name: str) -> None:
        """Let a connection go."""
        self._forget(name)

    def write_stop(self, name: str) -> None:
        """Write STOP on a connection, as it was handed over last."""
        descriptor, stop = self._links[name]
        os.write(descriptor, stop)

    def _forget(self, name: str) -> None:
        if name in self._links:
            os.close(self._links.pop(name)[0])
