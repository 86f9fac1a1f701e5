"""The instruments as the engine needs them. Drivers fit these by shape, not by inheritance."""

from collections.abc import Mapping, Sequence
from contextlib import AbstractAsyncContextManager
from typing import Literal, Protocol, runtime_checkable

Joints = tuple[float, float, float, float]
"""J1 deg, J2 deg, J3 mm, J4 deg."""


class DeviceIdentity(Protocol):
    """Who answers behind an endpoint."""

    @property
    def model(self) -> str: ...  # noqa: D102  # the attribute's name says it
    @property
    def firmware(self) -> str: ...  # noqa: D102  # the attribute's name says it
    @property
    def serial(self) -> str: ...  # noqa: D102  # the attribute's name says it
    @property
    def simulated(self) -> bool: ...  # noqa: D102  # the attribute's name says it


class ControllerStatus(Protocol):
    """State of a robot controller."""

    @property
    def servo_on(self) -> bool: ...  # noqa: D102  # the attribute's name says it
    @property
    def running(self) -> bool: ...  # noqa: D102  # the attribute's name says it
    @property
    def operation_enabled(self) -> bool: ...  # noqa: D102  # the attribute's name says it
    @property
    def emergency_stop(self) -> bool: ...  # noqa: D102  # the attribute's name says it
    @property
    def teach_mode(self) -> bool: ...  # noqa: D102  # the attribute's name says it
    @property
    def override_percent(self) -> float: ...  # noqa: D102  # the attribute's name says it
    @property
    def alarm_number(self) -> int: ...  # noqa: D102  # the attribute's name says it
    @property
    def alarm_text(self) -> str: ...  # noqa: D102  # the attribute's name says it
    @property
    def program(self) -> str: ...  # noqa: D102  # the attribute's name says it


class LengthReading(Protocol):
    """One reading of a length counter."""

    @property
    def displacement_mm(self) -> float: ...  # noqa: D102  # the attribute's name says it
    @property
    def time_s(self) -> float: ...  # noqa: D102  # the attribute's name says it


class BeamStatus(Protocol):
    """State of a length counter's beam."""

    @property
    def beam_ok(self) -> bool: ...  # noqa: D102  # the attribute's name says it
    @property
    def beam_lost(self) -> bool: ...  # noqa: D102  # the attribute's name says it
    @property
    def overspeed(self) -> bool: ...  # noqa: D102  # the attribute's name says it
    @property
    def laser_ready(self) -> bool: ...  # noqa: D102  # the attribute's name says it
    @property
    def signal(self) -> float: ...  # noqa: D102  # the attribute's name says it


class Air(Protocol):
    """State of the air."""

    @property
    def temperature_c(self) -> float | None: ...  # noqa: D102  # the attribute's name says it
    @property
    def pressure_hpa(self) -> float | None: ...  # noqa: D102  # the attribute's name says it
    @property
    def humidity_percent(self) -> float | None: ...  # noqa: D102  # the attribute's name says it


@runtime_checkable
class Robot(Protocol):
    """A robot controller that moves joints and stops."""

    async def connect(self) -> DeviceIdentity:
        """Open the link, check who answers, take the right to move."""
        ...

    async def close(self) -> None:
        """Give the right back and disconnect; may be called any number of times."""
        ...

    async def status(self) -> ControllerStatus:
        """Return the controller's state."""
        ...

    async def servo(self, *, on: bool) -> None:
        """Switch the drives and return when they are so."""
        ...

    async def set_override(self, percent: float) -> float:
        """Set the speed override; return what the controller reads back."""
        ...

    async def move_joints(self, target: Joints) -> None:
        """Interpolate all joints to the target; return when the motion is over."""
        ...

    async def joints(self) -> Joints:
        """Return the reported joint positions."""
        ...

    async def stop(self) -> None:
        """Stop now, past any command under way; return when the controller has taken it."""
        ...


@runtime_checkable
class WayRobot(Robot, Protocol):
    """A robot that passes joint targets without standing still at each."""

    async def follow(self, way: Sequence[Joints]) -> None:
        """Move through all targets in order; return when the robot stands at the last one."""
        ...


class JogFeed(Protocol):
    """What keeps a jog going."""

    def feed(self) -> None:
        """Keep moving for another moment; without it the robot stops by itself."""
        ...


@runtime_checkable
class JogRobot(Robot, Protocol):
    """A robot that turns joints while it is fed, and whose controller stops them when this program falls silent."""

    def jogging(self, directions: Mapping[str, Literal[-1, 1]]) -> AbstractAsyncContextManager[JogFeed]:
        """Turn joints, J1 to J4 by name, while what is yielded is fed; the robot stands when it is left."""
        ...


@runtime_checkable
class Interferometer(Protocol):
    """A length counter on a beam."""

    @property
    def compensated(self) -> Literal["none", "instrument"]:
        """Whether the instrument corrects its lengths for the air by itself."""
        ...

    async def connect(self) -> DeviceIdentity:
        """Open the link and check who answers."""
        ...

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        ...

    async def zero(self) -> int:
        """Zero the count, clear the latched faults; return the new zero's number."""
        ...

    async def read(self) -> LengthReading:
        """Return one reading."""
        ...

    async def status(self) -> BeamStatus:
        """Return the state of the beam."""
        ...


@runtime_checkable
class Environment(Protocol):
    """An air sensor."""

    async def connect(self) -> DeviceIdentity:
        """Open the link and check who answers."""
        ...

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        ...

    async def sample(self) -> Air:
        """Return the state of the air now."""
        ...


class Position(Protocol):
    """A position in the tracker's frame."""

    @property
    def x_mm(self) -> float: ...  # noqa: D102  # the attribute's name says it
    @property
    def y_mm(self) -> float: ...  # noqa: D102  # the attribute's name says it
    @property
    def u_mm(self) -> float: ...  # noqa: D102  # the attribute's name says it


@runtime_checkable
class Tracker(Protocol):
    """An independent instrument that locates the J4 axis."""

    async def connect(self) -> DeviceIdentity:
        """Open the link and check who answers."""
        ...

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        ...

    async def locate(self) -> Position:
        """Return the position of the J4 axis."""
        ...
