"""A robot controller: its state, its motions, and what some controllers are able to do beyond them."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Protocol

from catseye.drivers.roles.device import Device, DriverClass, Role
from catseye.drivers.roles.errors import RefusedError
from catseye.drivers.roles.pose import Pose, Range, Unit
from catseye.drivers.roles.text import DeviceText

Following = Literal["stops", "blended", "streamed"]
"""How an arm drives a path: it stops at every target, it passes the targets without standing still, or it is given a
set point in every cycle of the controller."""

JogDirection = Literal[-1, 1]


@dataclass(frozen=True)
class RobotStatus(DeviceText):
    """State of a robot controller.

    Attributes:
        servo_on: drives are powered.
        running: a motion or a program is under way.
        operation_enabled: this connection holds the right to move the robot.
        teach_mode: the key switch is at TEACH; motion commands are refused.
        emergency_stop: the emergency stop circuit is open.
        override_percent: speed override, read back.
        alarm_number: 0 when there is none.
        alarm_text: what the alarm means and what to do; empty when there is none.
        program: the program selected on the controller; empty when none is, or when the controller does not say.
        machine_locked: the controller carries out motions without moving the arm.
    """

    servo_on: bool
    running: bool
    operation_enabled: bool
    teach_mode: bool
    emergency_stop: bool
    override_percent: float
    alarm_number: int
    alarm_text: str
    program: str = ""
    machine_locked: bool = False


@dataclass(frozen=True)
class RobotAbilities:
    """What a robot's driver is able to do beyond single motions; a class attribute of the driver.

    Attributes:
        following: how it drives a path; "stops" never calls `follow`.
        jogs: `jogging` turns axes that stop by themselves when this program falls silent.
        takes_guard: `at` takes a setting `guard`, to which it hands its connections.
        further_endpoint: key of the [robot] section, and argument of `at`, with the endpoint of a connection of its
            own for paths; empty for none.
        numbers_alarms: the controller tells the number of its alarm; otherwise any alarm is number 1.
        steps: `step_axis` and `step_line` move by increments that the controller adds itself.
        switches_drives: `servo` switches the drives; otherwise it checks that an operator has, and `rest` is called
            at the end.
        torques: `torques` reads them.
        resets_alarms: `reset_alarm` resets them; otherwise whoever stands at the controller's pendant confirms them.
        command_resolution: smallest increment that can be commanded from where the controller says that an axis
            stands, by the unit of the axis: {"deg": 0.001}; None where its maker states none.
    """

    following: Following = "stops"
    jogs: bool = False
    takes_guard: bool = False
    further_endpoint: str = ""
    numbers_alarms: bool = True
    steps: bool = False
    switches_drives: bool = True
    torques: bool = False
    resets_alarms: bool = False
    command_resolution: Mapping[Unit, float] | None = None


class JogFeed(Protocol):
    """What keeps a jog going."""

    def feed(self) -> None:
        """Keep moving for another moment; without it the robot stops by itself."""
        ...


class Robot(Device, Protocol):
    """A robot controller that moves an arm and stops it.

    A pose has one value per axis of the arm description, deg or mm.
    """

    role: ClassVar[Role] = "robot"

    @property
    @abstractmethod
    def abilities(self) -> RobotAbilities:
        """What the driver is able to do; driver classes declare it as a class attribute."""
        ...

    @property
    def own_program(self) -> str | None:
        """Program of ours that runs on the controller: its name in capitals, "" where an operator starts it."""
        return None

    @property
    def read_back_limit(self) -> float:
        """How far an axis may be read back from the target of a motion that is over, deg or mm.

        The driver refuses a motion that ends farther off; 0 where controllers read back the very command.
        """
        return 0.0

    @abstractmethod
    async def status(self) -> RobotStatus:
        """Return the controller's state."""
        ...

    @abstractmethod
    async def servo(self, *, on: bool) -> None:
        """Switch the drives and return when they are so."""
        ...

    async def reset_alarm(self) -> None:
        """Reset the active alarm; nothing moves by that.

        Only for drivers whose abilities say so.

        Raises:
            AlarmError: it is still there.
            RefusedError: this controller has its alarms confirmed at its pendant.
        """
        raise RefusedError("this controller has its alarms confirmed at its pendant: confirm it there", 0)

    async def rest(self) -> str:
        """Hold an arm that stands as firmly as is possible without its drives; return what holds it, and what to do.

        Only for drivers whose abilities say that they switch no drives.
        """
        raise RefusedError("this robot's driver switches the drives off: nothing else holds its arm", 0)

    @abstractmethod
    async def set_override(self, percent: float) -> float:
        """Set the speed override; return what the controller reads back."""
        ...

    @abstractmethod
    async def move_joints(self, target: Pose) -> None:
        """Interpolate all axes to the target; return when the motion is over."""
        ...

    @abstractmethod
    async def joints(self) -> Pose:
        """Return the reported pose."""
        ...

    @abstractmethod
    async def stop(self) -> None:
        """Stop now, past any command under way; return when the controller has taken it."""
        ...

    async def follow(self, way: Sequence[Pose]) -> None:
        """Move through all targets in order; return when the robot stands at the last one.

        Only for drivers whose abilities say how.
        """
        raise RefusedError(f"this robot's driver drives no path of {len(way)} targets in one motion", 0)

    async def step_to(self, target: Pose) -> None:
        """Interpolate all axes to a target a step away; return when the motion is over.

        A driver whose `step_axis` goes at a speed of its own goes as slowly here: steps that are compared differ in
        nothing but what they start from. Other drivers move as always.
        """
        await self.move_joints(target)

    async def step_axis(self, axis: str, increment: float) -> None:
        """Move one axis by an increment from where it is measured to stand; return when the motion is over.

        The controller adds the increment, deg or mm, to the measured joint position, so that neither the deviation
        that the step before left nor the time a message takes enters the step.

        Only for drivers whose abilities say so.
        """
        raise RefusedError(f"this robot's driver steps no axis: {axis} stands, not moved by {increment:g}", 0)

    async def step_line(self, increment_mm: tuple[float, float, float]) -> None:
        """Move the tool along a straight line; return when the motion is over.

        Args:
            increment_mm: x, y and z of the step in the arm's base frame, from where the tool is measured to stand.
                The orientation is the measured one, so that the servos' errors turn the tool a little at every step.

        Only for drivers whose abilities say so.
        """
        raise RefusedError(f"this robot's driver steps along no line: {increment_mm} mm not moved", 0)

    async def torques(self) -> tuple[float, ...]:
        """Return the torques of the motors, N m, in the order of the axes.

        Raises:
            RefusedError: the driver or the controller has none.
        """
        raise RefusedError("this robot's driver reads no motor torques", 0)

    async def joint_limits(self) -> tuple[Range, ...] | None:
        """Return the controller's own limits of all axes, deg or mm; None where it does not say.

        Raises:
            RefusedError: this firmware does not answer the question.
            ProtocolError: the answer is none.
        """
        return None

    def jogging(self, directions: Mapping[str, JogDirection]) -> AbstractAsyncContextManager[JogFeed]:
        """Turn axes, by name, while what is yielded is fed; the robot stands when it is left.

        Only for drivers whose abilities say so.
        """
        raise RefusedError(
            f"this robot's driver cannot jog {', '.join(directions)} so that it ends by itself: move by steps",
            0,
        )

    @classmethod
    def stop_request(cls, settings: Any) -> bytes | None:
        """Return what stops the arm on a link on which anything may have been sent before; None for nothing.

        Args:
            settings: an instance of the driver's `Settings`.
        """
        del settings
        return None


class RobotClass(DriverClass, Protocol):
    """A robot's driver as it is registered.

    Attributes:
        abilities: what the driver is able to do.
    """

    abilities: ClassVar[RobotAbilities]

    @classmethod
    def stop_request(cls, settings: Any) -> bytes | None:
        """Return what stops the arm on a link; see `Robot.stop_request`."""
        ...
