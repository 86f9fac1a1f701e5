"""The devices of a cell while no run is under way: connected for whoever watches, let go before a run begins."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from app.engine.devices import Devices


class IdleBench:
    """Holds the links of a cell's devices between runs, each by itself.

    It is awake while somebody watches, and while something of it is lent or parked; asleep it holds no link.
    """

    def devices(self) -> Devices | None:
        """Return the devices, of which some may be out of reach; None while the bench is asleep or let go."""
        raise NotImplementedError

    @asynccontextmanager
    async def lent(self) -> AsyncIterator[Devices]:
        """Lend the bench to whoever moves the arm by hand; until then the robot is not sampled here.

        What the borrower reads, it hands on to `gauges` (`joints`, `status`). Beam, air and door are sampled on.
        A bench that is asleep is woken and waited for, for a bounded time.

        Raises:
            RefusedError: a run is under way or begins, the bench is lent already, or robot or interferometer are
                not connected; the text says why and what to do.
        """
        raise NotImplementedError
        yield

    @asynccontextmanager
    async def parked(self, device: str) -> AsyncIterator[None]:
        """Have the driver of one device closed meanwhile; its link state is "raw". It is connected again after it.

        Args:
            device: its name in the cell file.

        Raises:
            RefusedError: there is no such device, a run is under way or begins, the device is lent or parked
                already, or its driver does not let the link go.
        """
        raise NotImplementedError
        yield

    async def release(self) -> None:
        """Let every link go and stay so until `take_up`; returns when all are closed.

        Raises:
            RefusedError: something is lent or parked (end that first), or a driver does not let its link go.
        """
        raise NotImplementedError

    def take_up(self) -> None:
        """Hold the links again whenever they are wanted; the run is over."""
        raise NotImplementedError
