"""What a robot's driver gives the guard of the arm, and asks it before anything moves.

The guard is a process beside this program that says STOP when this one dies or falls silent. It needs a duplicate of
every connection on which STOP can be written.
"""

from collections.abc import AsyncIterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from typing import Protocol

from catseye.drivers.links.transport import Transport, WrappedTransport
from catseye.drivers.roles.errors import NotReadyError


class GuardError(NotReadyError):
    """Nothing moves: the arm has no owner here, no guard, or the guard has stopped it."""

    def __init__(self, text: str) -> None:
        super().__init__(text, 0)


class LinkGuard(Protocol):
    """Guards one arm."""

    def protect(self, name: str, descriptor: int, stop: bytes) -> None:
        """Take a duplicate of an open connection; one of the same name is let go.

        Args:
            name: what `release` will call the connection, without blanks.
            descriptor: number of its open socket or line.
            stop: bytes that stop the arm on it, whatever was written before.
        """
        ...

    async def release(self, name: str) -> None:
        """Let a connection go that is closed; when this returns nobody holds a duplicate any more."""
        ...

    def permit(self) -> None:
        """Check, without waiting, that a motion may be written now.

        Raises:
            GuardError: it may not.
        """
        ...

    def motion(self) -> AbstractAsyncContextManager[None]:
        """Have a motion guarded: the arm is stopped when this program falls silent meanwhile.

        Raises:
            GuardError: there is no guard.
        """
        ...


class Unguarded:
    """Guards nothing: for tests, and for a library user who moves an arm without the engine."""

    def protect(self, name: str, descriptor: int, stop: bytes) -> None:
        """Take nothing."""

    async def release(self, name: str) -> None:
        """Let nothing go."""

    def permit(self) -> None:
        """Let every motion begin."""

    @asynccontextmanager
    async def motion(self) -> AsyncIterator[None]:
        """Guard nothing."""
        yield


UNGUARDED = Unguarded()


def guarded(inner: Transport, guard: LinkGuard | None, name: str, stop: bytes) -> Transport:
    """Return a transport whose connection the guard, if there is one, has a duplicate of; see GuardedTransport."""
    return inner if guard is None else GuardedTransport(inner, guard, name, stop)


class GuardedTransport(WrappedTransport):
    """Has the guard keep a duplicate of a transport's connection while it is open.

    Args:
        name: of the connection, without blanks.
        stop: bytes that stop the arm on it; empty where only `protect` brings them.
    """

    def __init__(self, inner: Transport, guard: LinkGuard, name: str, stop: bytes) -> None:
        super().__init__(inner)
        self._guard = guard
        self._name = name
        self._stop = stop

    async def open(self) -> None:
        """Connect, and hand a duplicate to the guard.

        Raises:
            LinkError: unreachable.
        """
        await self._inner.open()
        if self._stop:
            self.protect(self._stop)

    def protect(self, stop: bytes) -> None:
        """Hand over a duplicate with other bytes that stop the arm: those of a protocol whose proofs grow old.

        Raises:
            LinkError: the link is closed.
        """
        self._guard.protect(self._name, self._inner.fileno(), stop)

    async def close(self) -> None:
        """Disconnect, and have the guard let its duplicate go; may be called any number of times."""
        try:
            await self._inner.close()
        finally:
            await self._guard.release(self._name)
