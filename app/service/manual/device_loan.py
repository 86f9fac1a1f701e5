"""What moving by hand needs of the bench between runs, and of its clients."""

from collections.abc import Awaitable, Callable, Mapping
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from catseye.app.engine.devices import Devices, WireRecorder
from catseye.app.protocol.events import AnyEvent
from catseye.app.service.watching.bench_facts import BenchFacts
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.io import Io
from catseye.drivers.roles.robot import Robot


class DeviceSource(Protocol):
    """Holds the links of the devices between runs; `catseye.app.service.watching.device_pool.DevicePool` fits."""

    def acquired(self) -> AbstractAsyncContextManager[Devices]:
        """Give the connected devices; nobody else asks the robot anything meanwhile.

        Raises:
            RefusedError: they cannot be had now.
        """
        ...

    def acquired_robot(self, device: str) -> AbstractAsyncContextManager[Robot]:
        """Give one robot of the cell by itself, to whoever has to stop it.

        Raises:
            RefusedError: it cannot be had now.
        """
        ...

    def detached(self, device: str) -> AbstractAsyncContextManager[None]:
        """Have one driver let its link go.

        Raises:
            RefusedError: it cannot be had now.
        """
        ...


Announce = Callable[[AnyEvent], None]
"""Sends every client an event."""


@dataclass(frozen=True)
class ManualBench:
    """A bench as whoever works on it by hand needs it.

    Attributes:
        pool: of the devices.
        facts: finds what cell file and last search say, now.
        identities: returns who answers, by the device's name, as far as it is known.
        record: takes the bytes that pass on a raw link.
        announce: sends every client an event.
        clock: real time.
        folder: of all runs.
        door: returns the block with the interlock; None where there is none, or nothing is connected.
        owned: makes this program the arm's owner meanwhile, for what is said.
    """

    pool: DeviceSource
    facts: Callable[[], Awaitable[BenchFacts]]
    identities: Callable[[], Mapping[str, Identity]]
    record: WireRecorder
    announce: Announce
    clock: Clock
    folder: Path
    door: Callable[[], Io | None]
    owned: Callable[[str], AbstractAsyncContextManager[None]]
