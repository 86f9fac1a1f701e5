"""The devices of a cell while no run is under way: connected for whoever watches, let go before a run begins."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass

from catseye.app.engine.devices import Devices
from catseye.app.engine.waiting import cancel, uncancelled
from catseye.app.exitcode import ExitCode
from catseye.app.service.errors import RefusedError
from catseye.app.service.watching.device_supervisor import DeviceSupervisor
from catseye.app.service.watching.latest_values import LatestValues
from catseye.app.service.watching.observed_devices import ObservedController, ObservedDevice
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.robot import Robot

_JOG_DEVICES = ("robot", "interferometer")
"""What has to be connected before the arm is moved by hand, as far as the cell has it."""

WAKING_LIMIT_S = 10.0
"""Real seconds that a borrower waits for the devices."""

_WAKING_POLL_S = 0.05


@dataclass(frozen=True)
class CellDevices:
    """Every device of a cell, none connected.

    Attributes:
        devices: those that a run has.
        kept: all of them, by name in the cell file.
    """

    devices: Devices
    kept: dict[str, ObservedDevice]


class DevicePool:
    """Holds the links of a cell's devices between runs, each by itself.

    It is awake while somebody watches, and while something of it is acquired or detached; asleep it holds no link.

    Args:
        make: makes the devices as the cell file has them now.
        latest: takes what the devices report.
        clock: real time.
        on_trouble: called with why there are no devices.
    """

    def __init__(
        self,
        make: Callable[[], Awaitable[CellDevices]],
        latest: LatestValues,
        clock: Clock,
        on_trouble: Callable[[str], None],
    ) -> None:
        self._make = make
        self._latest = latest
        self._clock = clock
        self._on_trouble = on_trouble
        self._devices: Devices | None = None
        self._supervisors: dict[str, DeviceSupervisor] = {}
        self._stuck: list[DeviceSupervisor] = []
        self._settling = asyncio.Lock()
        self._tasks: set[asyncio.Task[None]] = set()
        self._watched = False
        self._away = False
        self._acquired: set[str] = set()

    @property
    def acquired_devices(self) -> list[str]:
        """Names of the devices that are acquired or detached."""
        return sorted(self._acquired)

    def devices(self) -> Devices | None:
        """Return the devices, of which some may be out of reach; None while the bench is asleep or let go."""
        return self._devices

    def watched(self, on: bool) -> None:
        """Wake up since somebody watches, or fall asleep since nobody does."""
        self._watched = on
        self._settle_soon()

    @asynccontextmanager
    async def acquired(self) -> AsyncIterator[Devices]:
        """Give the bench to whoever moves the arm by hand; meanwhile the robot is not sampled here.

        What the borrower asks of these devices is seen by those who watch. Beam, air and door are sampled on. A bench
        that is asleep is woken and waited for, for a bounded time.

        Raises:
            RefusedError: a run is under way or begins, robot or interferometer are acquired or detached already, or
                not connected; the text says why and what to do.
        """
        async with self._taken(*_JOG_DEVICES) as devices:
            await self._require_connected(*(name for name in _JOG_DEVICES if name in devices.named()))
            async with self._unasked("robot"):
                yield devices

    @asynccontextmanager
    async def acquired_robot(self, device: str) -> AsyncIterator[Robot]:
        """Give one robot of the cell by itself, to whoever has to stop it: what else is out of reach does not matter.

        Raises:
            RefusedError: a run is under way or begins, the device is acquired or detached already, not connected, or
                it is no robot.
        """
        async with self._taken(device):
            await self._require_connected(device)
            async with self._unasked(device):
                robot = self._supervisors[device].device
                if not isinstance(robot, ObservedController):
                    raise RefusedError(f"{device} is not a robot: its driver cannot stop what moves")
                yield robot

    @asynccontextmanager
    async def detached(self, device: str) -> AsyncIterator[None]:
        """Have the driver of one device closed meanwhile; its link state is "raw". It is connected again after it.

        Raises:
            RefusedError: there is no such device, a run is under way or begins, the device is acquired or detached
                already, or its driver does not let the link go.
        """
        async with self._taken(device):
            supervisor = self._supervisors.get(device)
            if supervisor is None:
                raise RefusedError(f"there is no device {device!r}; there are {', '.join(self._supervisors)}")
            try:
                # Whole: a supervisor that is begun anew before it has ended would ask twice.
                _require_free(await uncancelled(supervisor.let_go()))
                self._latest.taken(device)
                yield
            finally:
                self._latest.wanted(device)
                supervisor.begin()

    async def release(self) -> None:
        """Let every link go and stay so until `take_up`; returns when all are closed.

        Raises:
            RefusedError: something is acquired or detached (end that first), or a driver does not let its link go.
        """
        if self._acquired:
            raise RefusedError(f"{', '.join(self.acquired_devices)}: used by hand: end that first")
        self._away = True
        await self._settle()
        _require_free(*[await supervisor.let_go() for supervisor in self._stuck])
        self._stuck.clear()

    def take_up(self) -> None:
        """Hold the links again whenever they are wanted; the run is over."""
        self._away = False
        self._settle_soon()

    async def end(self) -> None:
        """Let every link go for good."""
        self._away = True
        await self._settle()
        await cancel(*self._tasks)

    @asynccontextmanager
    async def _taken(self, *names: str) -> AsyncIterator[Devices]:
        """Mark devices as used by hand, and wake the bench meanwhile."""
        if self._away:
            raise RefusedError("a run is under way or begins: nothing is done by hand until it is over")
        if twice := self._acquired.intersection(names):
            raise RefusedError(f"{', '.join(sorted(twice))}: used by hand already: end that first")
        self._acquired.update(names)
        try:
            await self._settle()
            if self._devices is None:
                raise RefusedError("the devices of the cell cannot be made: check the cell file")
            yield self._devices
        finally:
            self._acquired.difference_update(names)
            self._settle_soon()

    async def _require_connected(self, *names: str) -> None:
        """Wait until devices are connected, for a bounded time.

        Raises:
            RefusedError: one is not.
        """
        end_s = self._clock.monotonic_s() + WAKING_LIMIT_S
        while missing := [name for name in names if not self._is_connected(name)]:
            link = self._latest.link(missing[0])
            if link.state == "lost" or self._clock.monotonic_s() >= end_s:
                why = link.error or f"it does not answer within {WAKING_LIMIT_S:g} s"
                raise RefusedError(f"{missing[0]} is not connected: {why}", ExitCode.DEVICE)
            await self._clock.sleep(_WAKING_POLL_S)

    @asynccontextmanager
    async def _unasked(self, name: str) -> AsyncIterator[None]:
        """Ask a connected device nothing here meanwhile.

        Raises:
            RefusedError: it was lost while a question was waited for: who answers next is not known yet.
        """
        async with self._supervisors[name].asking:
            if not self._is_connected(name):
                raise RefusedError(
                    f"{name} is not connected: {self._latest.link(name).error}", ExitCode.DEVICE
                )
            yield

    def _is_connected(self, name: str) -> bool:
        return name in self._supervisors and self._supervisors[name].connected

    def _settle_soon(self) -> None:
        task = asyncio.create_task(self._settle())
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _settle(self) -> None:
        """Bring the bench to where it should be now."""
        async with self._settling:
            wanted = (self._watched or bool(self._acquired)) and not self._away
            if wanted and self._devices is None:
                await self._bring_up()
            elif not wanted and self._devices is not None:
                await self._take_down()

    async def _bring_up(self) -> None:
        try:
            made = await self._make()
        except Exception as error:  # noqa: BLE001  # a cell file that is being edited must not end the engine
            self._on_trouble(f"the devices of the cell cannot be made: {error}")
            return
        stuck = {
            supervisor.name: trouble for supervisor in self._stuck if (trouble := await supervisor.let_go())
        }
        self._stuck = [supervisor for supervisor in self._stuck if supervisor.name in stuck]
        self._devices = made.devices
        self._supervisors = {
            name: DeviceSupervisor(device, self._latest, self._clock) for name, device in made.kept.items()
        }
        for name, supervisor in self._supervisors.items():
            self._latest.wanted(name)
            if name in stuck:
                self._latest.lost(name, stuck[name])
            else:
                supervisor.begin()

    async def _take_down(self) -> None:
        """Let every link go, all at the same time."""
        supervisors = list(self._supervisors.values())
        self._devices, self._supervisors = None, {}
        troubles = await uncancelled(_all_let_go(supervisors))
        self._stuck += [
            supervisor for supervisor, trouble in zip(supervisors, troubles, strict=True) if trouble
        ]


async def _all_let_go(supervisors: list[DeviceSupervisor]) -> list[str]:
    return await asyncio.gather(*(supervisor.let_go() for supervisor in supervisors))


def _require_free(*troubles: str) -> None:
    """Raise what keeps a link from being free.

    Raises:
        RefusedError: a driver did not let it go.
    """
    if faults := "; ".join(filter(None, troubles)):
        raise RefusedError(f"{faults}: check that device and try again", ExitCode.DEVICE)
