"""Devices whose answers pass on to latest: what anybody asks of them is seen by everybody who watches."""

from collections.abc import Awaitable, Callable, Sequence
from typing import Any, Literal, Protocol, TypeVar, runtime_checkable

from catseye.app.engine.devices import Devices
from catseye.app.engine.interlock import Light, RemoteIo
from catseye.app.service.watching.latest_values import LatestValues
from catseye.drivers.roles.errors import DeviceError, LinkError, ProtocolError
from catseye.drivers.roles.protocols import (
    Air,
    BeamStatus,
    ControllerStatus,
    DeviceIdentity,
    Environment,
    Interferometer,
    Joints,
    LengthReading,
    Position,
    Robot,
    Tracker,
    WayRobot,
)

T = TypeVar("T")


class Connecting(Protocol):
    """What every device does."""

    async def connect(self) -> DeviceIdentity:
        """Open the link and check who answers."""
        ...

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        ...


@runtime_checkable
class Streaming(Protocol):
    """A driver that is sent values without asking for them.

    Attributes:
        on_value: takes each of them: time of arrival on the driver's clock, s, and displacement, mm.
    """

    on_value: Callable[[float, float], None] | None


class ObservedDevice:
    """Tells latest how the link of a device fares.

    Args:
        name: of the device in the cell file.
        driver: that does the work.
        latest: takes what is observed.

    Attributes:
        driver: what stands behind this.
    """

    def __init__(self, name: str, driver: Connecting, latest: LatestValues) -> None:
        self.name = name
        self.driver: Any = driver
        self._latest = latest
        self._pending = 0

    @property
    def busy(self) -> bool:
        """Somebody waits for an answer of the device."""
        return self._pending > 0

    @property
    def notes(self) -> tuple[str, ...]:
        """What the driver knows about its connection."""
        notes: tuple[str, ...] = getattr(self.driver, "notes", ())
        return notes

    async def connect(self) -> DeviceIdentity:
        """Open the link and check who answers."""
        self._latest.connecting(self.name)
        try:
            identity: DeviceIdentity = await self.driver.connect()
        except DeviceError as error:
            self._latest.lost(self.name, str(error))
            raise
        self._latest.connected(self.name, identity)
        return identity

    async def close(self) -> None:
        """Disconnect."""
        try:
            await self.driver.close()
        finally:
            self._latest.closed(self.name)

    async def _answered(self, answer: Awaitable[T]) -> T:
        """Return an answer; what becomes of the link is seen on the way."""
        self._pending += 1
        try:
            found = await answer
        except (LinkError, ProtocolError) as error:
            self._latest.lost(self.name, str(error))
            raise
        except DeviceError:
            self._latest.answered(self.name)
            raise
        finally:
            self._pending -= 1
        self._latest.answered(self.name)
        return found


class ObservedRobot(ObservedDevice):
    """A robot controller; what its driver does beyond this is found at `driver`."""

    driver: Robot

    async def status(self) -> ControllerStatus:
        """Return the controller's state."""
        status = await self._answered(self.driver.status())
        self._latest.take_status(status)
        return status

    async def servo(self, *, on: bool) -> None:
        """Switch the drives."""
        await self._answered(self.driver.servo(on=on))

    async def set_override(self, percent: float) -> float:
        """Set the speed override; return what the controller reads back."""
        return await self._answered(self.driver.set_override(percent))

    async def move_joints(self, target: Joints) -> None:
        """Interpolate all joints to the target."""
        await self._answered(self.driver.move_joints(target))

    async def joints(self) -> Joints:
        """Return the reported joint positions."""
        joints = await self._answered(self.driver.joints())
        self._latest.take_joints(joints)
        return joints

    async def stop(self) -> None:
        """Stop now, past any command under way."""
        await self._answered(self.driver.stop())


class ObservedWayRobot(ObservedRobot):
    """A robot that passes joint targets without standing still at each."""

    driver: WayRobot

    async def follow(self, way: Sequence[Joints]) -> None:
        """Move through all targets in order."""
        await self._answered(self.driver.follow(way))


class ObservedInterferometer(ObservedDevice):
    """A length counter on the beam; one that streams has every value seen, one that is asked the answers."""

    driver: Interferometer

    def __init__(self, name: str, driver: Interferometer, latest: LatestValues) -> None:
        super().__init__(name, driver, latest)
        self.streams = isinstance(driver, Streaming)
        if isinstance(driver, Streaming):
            driver.on_value = lambda _time_s, displacement_mm: latest.take_displacement(displacement_mm)

    @property
    def compensated(self) -> Literal["none", "instrument"]:
        """Whether the instrument corrects its lengths for the air by itself."""
        return self.driver.compensated

    async def zero(self) -> int:
        """Zero the count; return the new zero's number."""
        return await self._answered(self.driver.zero())

    async def read(self) -> LengthReading:
        """Return one reading."""
        reading = await self._answered(self.driver.read())
        if not self.streams:
            self._latest.take_displacement(reading.displacement_mm)
        return reading

    async def status(self) -> BeamStatus:
        """Return the state of the beam."""
        beam = await self._answered(self.driver.status())
        self._latest.take_beam(beam)
        return beam


class ObservedSensor(ObservedDevice):
    """A sensor whose samples are nobody's but the asker's."""

    driver: Environment

    async def sample(self) -> Air:
        """Return the state of the air now."""
        return await self._answered(self.driver.sample())


class ObservedAir(ObservedSensor):
    """The sensor of the air that the beam passes."""

    async def sample(self) -> Air:
        """Return the state of the air now."""
        air = await super().sample()
        self._latest.take_air(air)
        return air


class ObservedIo(ObservedDevice):
    """Door interlock and stack light."""

    driver: RemoteIo

    async def door_closed(self) -> bool:
        """Return whether the door is closed now."""
        closed = await self._answered(self.driver.door_closed())
        self._latest.take_door(closed)
        return closed

    async def show(self, light: Light) -> None:
        """Light one lamp and put the others out."""
        await self._answered(self.driver.show(light))


class ObservedTracker(ObservedDevice):
    """An independent instrument."""

    driver: Tracker

    async def locate(self) -> Position:
        """Return the position of the J4 axis."""
        return await self._answered(self.driver.locate())


def observed(devices: Devices, latest: LatestValues, material: str | None) -> Devices:
    """Return devices that do the same and are seen.

    Args:
        devices: of a run, or of the bench between runs.
        latest: takes what is observed.
        material: name of the sensor of the links' temperature in the cell file.
    """
    robot = devices.robot
    way = isinstance(robot, WayRobot)
    return Devices(
        ObservedWayRobot("robot", robot, latest) if way else ObservedRobot("robot", robot, latest),
        ObservedInterferometer("interferometer", devices.interferometer, latest),
        ObservedAir("environment", devices.environment, latest),
        None if devices.tracker is None else ObservedTracker("tracker", devices.tracker, latest),
        None if devices.io is None else ObservedIo("io", devices.io, latest),
        None
        if devices.material is None
        else ObservedSensor(material or "material", devices.material, latest),
        devices.guard,
    )
