"""Devices whose answers pass on to latest: what anybody asks of them is seen by everybody who watches."""

from collections.abc import Awaitable, Mapping, Sequence
from contextlib import AbstractAsyncContextManager
from typing import TypeVar

from catseye.app.engine.devices import Devices
from catseye.app.service.watching.latest_values import LatestValues
from catseye.drivers.roles.air import AirSample, AirSensor
from catseye.drivers.roles.device import Device, Examination, Identity
from catseye.drivers.roles.errors import DeviceError, LinkError, ProtocolError
from catseye.drivers.roles.interferometer import (
    BeamStatus,
    Compensated,
    Interferometer,
    LengthReading,
    OnValue,
)
from catseye.drivers.roles.io import Io, Light
from catseye.drivers.roles.pose import Pose, Range
from catseye.drivers.roles.robot import JogDirection, JogFeed, Robot, RobotAbilities, RobotStatus
from catseye.drivers.roles.tracker import (
    Face,
    Place,
    Position,
    TargetPoint,
    TargetPose,
    Tracker,
    TrackerAbilities,
)

T = TypeVar("T")


class ObservedDevice(Device):
    """Reports to `latest` how the link of a device fares.

    Attributes:
        name: of the device in the cell file.
    """

    def __init__(self, name: str, driver: Device, latest: LatestValues) -> None:
        self.name = name
        self._device = driver
        self._latest = latest
        self._pending = 0

    @property
    def busy(self) -> bool:
        """Somebody waits for an answer of the device."""
        return self._pending > 0

    @property
    def notes(self) -> tuple[str, ...]:
        """What the driver knows about its connection."""
        return self._device.notes

    async def connect(self) -> Identity:
        """Open the link and check who answers."""
        self._latest.connecting(self.name)
        try:
            identity = await self._device.connect()
        except DeviceError as error:
            self._latest.lost(self.name, str(error))
            raise
        self._latest.connected(self.name, identity)
        return identity

    async def close(self) -> None:
        """Disconnect."""
        try:
            await self._device.close()
        finally:
            self._latest.closed(self.name)

    async def examine(self) -> Examination:
        """Ask the instrument what its maker provides beyond the role."""
        return await self._answered(self._device.examine())

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


class ObservedController(ObservedDevice, Robot):
    """A robot controller whose state is nobody's but the asker's."""

    def __init__(self, name: str, driver: Robot, latest: LatestValues) -> None:
        super().__init__(name, driver, latest)
        self._driver = driver

    @property
    def abilities(self) -> RobotAbilities:
        """What the driver is able to do."""
        return self._driver.abilities

    @property
    def own_program(self) -> str | None:
        """Program of the driver that runs on the controller."""
        return self._driver.own_program

    @property
    def read_back_limit(self) -> float:
        """How far an axis may be read back from the target of a motion."""
        return self._driver.read_back_limit

    async def status(self) -> RobotStatus:
        """Return the controller's state."""
        return await self._answered(self._driver.status())

    async def servo(self, *, on: bool) -> None:
        """Switch the drives."""
        await self._answered(self._driver.servo(on=on))

    async def reset_alarm(self) -> None:
        """Reset the active alarm."""
        await self._answered(self._driver.reset_alarm())

    async def rest(self) -> str:
        """Hold an arm that stands without switching its drives."""
        return await self._answered(self._driver.rest())

    async def set_override(self, percent: float) -> float:
        """Set the speed override; return what the controller reads back."""
        return await self._answered(self._driver.set_override(percent))

    async def move_joints(self, target: Pose) -> None:
        """Interpolate all axes to the target."""
        await self._answered(self._driver.move_joints(target))

    async def follow(self, way: Sequence[Pose]) -> None:
        """Move through all targets in order."""
        await self._answered(self._driver.follow(way))

    async def joints(self) -> Pose:
        """Return the reported pose."""
        return await self._answered(self._driver.joints())

    async def step_to(self, target: Pose) -> None:
        """Interpolate all axes to a target a step away."""
        await self._answered(self._driver.step_to(target))

    async def step_axis(self, axis: str, increment: float) -> None:
        """Move one axis by an increment from where it is measured to stand."""
        await self._answered(self._driver.step_axis(axis, increment))

    async def step_line(self, increment_mm: tuple[float, float, float]) -> None:
        """Move the tool along a straight line."""
        await self._answered(self._driver.step_line(increment_mm))

    async def torques(self) -> tuple[float, ...]:
        """Return the torques of the motors, N m."""
        return await self._answered(self._driver.torques())

    async def joint_limits(self) -> tuple[Range, ...] | None:
        """Return the controller's own limits of all axes."""
        return await self._answered(self._driver.joint_limits())

    def jogging(self, directions: Mapping[str, JogDirection]) -> AbstractAsyncContextManager[JogFeed]:
        """Turn axes while what is yielded is fed."""
        return self._driver.jogging(directions)

    async def stop(self) -> None:
        """Stop now, past any command under way."""
        await self._answered(self._driver.stop())


class ObservedRobot(ObservedController):
    """The controller of the arm that measures."""

    async def status(self) -> RobotStatus:
        """Return the controller's state."""
        status = await super().status()
        self._latest.take_status(status)
        return status

    async def joints(self) -> Pose:
        """Return the reported pose."""
        joints = await super().joints()
        self._latest.take_joints(joints)
        return joints

    async def torques(self) -> tuple[float, ...]:
        """Return the torques of the motors, N m."""
        torques_nm = await super().torques()
        self._latest.take_torques(torques_nm)
        return torques_nm


class ObservedInterferometer(ObservedDevice, Interferometer):
    """A length counter on the beam; one that streams has every value seen, one that is asked the answers."""

    def __init__(self, name: str, driver: Interferometer, latest: LatestValues) -> None:
        super().__init__(name, driver, latest)
        self._driver = driver
        self.listen(None)

    @property
    def compensated(self) -> Compensated:
        """Who corrects the lengths for the air."""
        return self._driver.compensated

    @property
    def streams(self) -> bool:
        """Values arrive without being asked for."""
        return self._driver.streams

    def listen(self, on_value: OnValue | None) -> None:
        """Have every value of a stream shown beside the latest; None ends that."""

        def both(time_s: float, displacement_mm: float) -> None:
            self._latest.take_displacement(displacement_mm)
            if on_value is not None:
                on_value(time_s, displacement_mm)

        self._driver.listen(both)

    async def zero(self) -> int:
        """Zero the count; return the new zero's number."""
        return await self._answered(self._driver.zero())

    async def read(self) -> LengthReading:
        """Return one reading."""
        reading = await self._answered(self._driver.read())
        if not self.streams:
            self._latest.take_displacement(reading.displacement_mm)
        return reading

    async def status(self) -> BeamStatus:
        """Return the state of the beam."""
        beam = await self._answered(self._driver.status())
        self._latest.take_beam(beam)
        return beam


class ObservedSensor(ObservedDevice, AirSensor):
    """A sensor whose samples are nobody's but the asker's."""

    def __init__(self, name: str, driver: AirSensor, latest: LatestValues) -> None:
        super().__init__(name, driver, latest)
        self._driver = driver

    async def sample(self) -> AirSample:
        """Return the state of the air now."""
        return await self._answered(self._driver.sample())


class ObservedAir(ObservedSensor):
    """The sensor of the air that the beam passes."""

    async def sample(self) -> AirSample:
        """Return the state of the air now."""
        air = await super().sample()
        self._latest.take_air(air)
        return air


class ObservedIo(ObservedDevice, Io):
    """Door interlock and stack light."""

    def __init__(self, name: str, driver: Io, latest: LatestValues) -> None:
        super().__init__(name, driver, latest)
        self._driver = driver

    async def door_closed(self) -> bool:
        """Return whether the door is closed now."""
        closed = await self._answered(self._driver.door_closed())
        self._latest.take_door(closed)
        return closed

    async def show(self, light: Light) -> None:
        """Light one lamp and put the others out."""
        await self._answered(self._driver.show(light))


class ObservedTracker(ObservedDevice, Tracker):
    """An independent instrument."""

    def __init__(self, name: str, driver: Tracker, latest: LatestValues) -> None:
        super().__init__(name, driver, latest)
        self._driver = driver

    @property
    def abilities(self) -> TrackerAbilities:
        """What the driver is able to do."""
        return self._driver.abilities

    async def locate(self) -> Position:
        """Return the position of the target in the plane."""
        return await self._answered(self._driver.locate())

    async def point(
        self, target: str, dwell_s: float, near_mm: Place | None = None, face: Face = 1
    ) -> TargetPoint:
        """Measure a target that stands still."""
        return await self._answered(self._driver.point(target, dwell_s, near_mm, face))

    async def pose(self, target: str, dwell_s: float) -> TargetPose:
        """Measure a frame that stands still."""
        return await self._answered(self._driver.pose(target, dwell_s))


def observed(devices: Devices, latest: LatestValues, material: str | None) -> Devices:
    """Return devices that do the same and are seen.

    Args:
        material: name of the sensor of the links' temperature in the cell file.
    """
    return Devices(
        ObservedRobot("robot", devices.robot, latest),
        None
        if devices.interferometer is None
        else ObservedInterferometer("interferometer", devices.interferometer, latest),
        None if devices.environment is None else ObservedAir("environment", devices.environment, latest),
        None if devices.tracker is None else ObservedTracker("tracker", devices.tracker, latest),
        None if devices.io is None else ObservedIo("io", devices.io, latest),
        None
        if devices.material is None
        else ObservedSensor(material or "material", devices.material, latest),
        devices.guard,
    )
