"""What moving by hand needs of the bench between runs, and of whoever is told."""

from collections.abc import Awaitable, Callable, Mapping
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from catseye.app.engine.devices import Devices, WireRecorder
from catseye.app.engine.interlock import RemoteIo
from catseye.app.service.watching.bench_facts import BenchFacts
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.protocols import DeviceIdentity, Robot
from catseye.procedures.kit.context import Json


class Lender(Protocol):
    """Holds the links of the devices between runs; `catseye.app.service.watching.device_pool.IdleBench` fits."""

    def lent(self) -> AbstractAsyncContextManager[Devices]:
        """Lend the connected devices; nobody else asks the robot anything meanwhile.

        Raises:
            RefusedError: they cannot be had now.
        """
        ...

    def lent_robot(self, device: str) -> AbstractAsyncContextManager[Robot]:
        """Lend one robot of the cell by itself, to whoever has to stop it.

        Raises:
            RefusedError: it cannot be had now.
        """
        ...

    def parked(self, device: str) -> AbstractAsyncContextManager[None]:
        """Have one driver let its link go.

        Raises:
            RefusedError: it cannot be had now.
        """
        ...


class Tell(Protocol):
    """Tells every client an event."""

    def __call__(self, event: str, **fields: Json) -> None:
        """Take its name and fields."""
        ...


@dataclass(frozen=True)
class HandBench:
    """A bench as whoever works on it by hand needs it.

    Attributes:
        lender: of the devices.
        facts: finds what cell file and last search say, now.
        identities: returns who answers, by the device's name, as far as it is known.
        record: takes the bytes that pass on a raw link.
        tell: tells every client.
        clock: real time.
        folder: of all runs.
        door: returns the block with the interlock; None where there is none, or nothing is connected.
    """

    lender: Lender
    facts: Callable[[], Awaitable[BenchFacts]]
    identities: Callable[[], Mapping[str, DeviceIdentity]]
    record: WireRecorder
    tell: Tell
    clock: Clock
    folder: Path
    door: Callable[[], RemoteIo | None]
