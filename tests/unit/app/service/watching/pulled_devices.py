"""Devices that can be pulled and that can hang, a cell of them, and clients that watch."""

import asyncio
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

from catseye.app.engine.devices import Devices
from catseye.app.engine.handle import RunHandle
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.message import JsonObject
from catseye.app.service.watching.device_pool import CellDevices
from catseye.app.service.watching.latest_values import LatestValues
from catseye.app.service.watching.observed_devices import ObservedDevice, observed
from catseye.app.service.watching.telemetry import Topic
from catseye.drivers.roles.air import AirSample, AirSensor
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import DeviceError, LinkError
from catseye.drivers.roles.interferometer import (
    BeamStatus,
    Compensated,
    Interferometer,
    LengthReading,
    OnValue,
)
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import Robot, RobotAbilities, RobotStatus
from tests.unit.drivers.virtual_time import VirtualClock


@dataclass
class Pulled:
    """A device with a plug.

    Attributes:
        error: what every question is answered with; None while it is plugged in.
        refusal: what questions are refused with, on a link that is well.
        hangs: closing waits for this, whatever becomes of whoever waits.
        open: the link is held.
        log: what was asked.
    """

    error: DeviceError | None = None
    refusal: DeviceError | None = None
    hangs: asyncio.Event | None = None
    open: bool = False
    log: list[str] = field(default_factory=list)
    times_s: list[float] = field(default_factory=list)

    async def connect(self) -> Identity:
        self.times_s.append(VirtualClock().monotonic_s())
        await self._asked("connect")
        self.open = True
        return Identity("model", "1.0", "7", simulated=True)

    async def close(self) -> None:
        self.log.append("close")
        if self.hangs is not None:
            await self.hangs.wait()
        self.open = False

    async def _asked(self, what: str) -> None:
        self.log.append(what)
        await asyncio.sleep(0.005)
        if self.error is not None:
            raise self.error
        if self.refusal is not None and what != "connect":
            raise self.refusal


@dataclass
class PulledRobot(Pulled, Robot):
    abilities: ClassVar[RobotAbilities] = RobotAbilities()

    async def status(self) -> RobotStatus:
        await self._asked("status")
        return RobotStatus(True, False, True, False, False, 10.0, 0, "")

    async def joints(self) -> Pose:
        await self._asked("joints")
        return (1.0, 2.0, 3.0, 4.0)

    async def servo(self, *, on: bool) -> None:
        await self._asked(f"servo {on}")

    async def set_override(self, percent: float) -> float:
        await self._asked("override")
        return percent

    async def move_joints(self, target: Pose) -> None:
        await self._asked(f"move {target}")

    async def stop(self) -> None:
        await self._asked("stop")


@dataclass
class PulledCounter(Pulled, Interferometer):
    compensated: Compensated = "none"

    async def zero(self) -> int:
        await self._asked("zero")
        return 1

    async def read(self) -> LengthReading:
        await self._asked("read")
        return LengthReading(0.25, "", VirtualClock().monotonic_s())

    async def status(self) -> BeamStatus:
        await self._asked("status")
        return BeamStatus(True, False, False, True, 0.8, "800 mV")


@dataclass
class StreamingCounter(PulledCounter):
    streams: bool = True
    on_value: OnValue | None = None

    def listen(self, on_value: OnValue | None) -> None:
        self.on_value = on_value


@dataclass
class PulledAir(Pulled, AirSensor):
    async def sample(self) -> AirSample:
        await self._asked("sample")
        return AirSample(20.0, 1013.25, 50.0, VirtualClock().monotonic_s())


@dataclass
class PulledCell:
    """A robot, a counter and an air sensor, made anew each time as in a cell; the plugs stay the same."""

    robot: PulledRobot = field(default_factory=PulledRobot)
    counter: PulledCounter = field(default_factory=PulledCounter)
    air: PulledAir = field(default_factory=PulledAir)
    fault: Exception | None = None

    def everyone(self) -> tuple[Pulled, ...]:
        return self.robot, self.counter, self.air

    def observed(self, latest: LatestValues) -> Devices:
        return observed(Devices(self.robot, self.counter, self.air), latest, None)

    async def made(self, latest: LatestValues) -> CellDevices:
        if self.fault is not None:
            raise self.fault
        devices = self.observed(latest)
        kept: dict[str, ObservedDevice] = {}
        for device in devices.named().values():
            assert isinstance(device, ObservedDevice)
            kept[device.name] = device
        return CellDevices(devices, kept)


@dataclass
class Listeners:
    """Implements `catseye.app.service.watching.telemetry.Audience`: what everybody received, and when."""

    topics: set[Topic] = field(default_factory=set)
    run: RunHandle | None = None
    asking: bool = False
    received: list[tuple[float, str, JsonObject]] = field(default_factory=list)

    def listens(self, topic: Topic) -> bool:
        return topic in self.topics

    def publish_topic(self, topic: Topic, event: AnyEvent) -> None:
        assert topic in self.topics
        self.received.append((VirtualClock().monotonic_s(), event.event, event.json_object()))

    def of(self, event: str) -> list[dict[str, Any]]:
        return [fields for _, name, fields in self.received if name == event]


async def disk(_folder: Path) -> int:
    """Look at no disk: a thread knows no virtual time."""
    return 1000


def lost() -> LinkError:
    return LinkError("no cable: plug it in")
