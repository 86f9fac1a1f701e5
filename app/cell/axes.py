"""The arm of a cell: axes from its description, ranges as the cell narrows them."""

from collections.abc import Mapping, Sequence
from typing import cast

from catseye.app.cell.arm import ArmDescription, Joint, arm_description
from catseye.app.cell.model import Robot
from catseye.app.errors import ConfigError
from catseye.drivers.roles.pose import Axes, Axis
from catseye.drivers.roles.registry import driver_names, load_driver
from catseye.drivers.roles.robot import RobotClass
from catseye.procedures.kit.bench import Arm


def axes_of(description: ArmDescription, limits: Mapping[str, Sequence[float]]) -> Axes:
    """Return the axes of an arm.

    Args:
        limits: narrower ranges by name of the joint in lower case, deg or mm.
    """
    return tuple(_axis(joint, limits.get(joint.name.lower(), joint.range)) for joint in description.joint)


def _axis(joint: Joint, limits: Sequence[float]) -> Axis:
    low, high = limits
    return Axis(joint.name, joint.unit, low, high, joint.speed, joint.acceleration)


def _test_places(joint: Joint) -> tuple[float, ...]:
    return tuple((joint.type == "revolute" and joint.test_places_deg) or ())


def arm_of(robot: Robot) -> Arm:
    """Return the arm of a cell as its description and [robot.limits_deg] have it.

    Raises:
        ConfigError: its driver is not installed, or is none of a robot.
    """
    description = arm_description(robot.arm)
    axes = axes_of(description, robot.limits_deg.model_dump(exclude_unset=True))
    abilities = robot_driver(robot.driver).abilities
    return Arm(
        axes=axes,
        range_keys=tuple(f"limits_deg.{axis.name.lower()}" for axis in axes),
        override_percent=robot.override_cap_percent,
        following=abilities.following,
        follow_speed_deg_s=robot.follow_speed_deg_s,
        follow_acceleration_deg_s2=robot.follow_acceleration_deg_s2,
        test_places=tuple(map(_test_places, description.joint)),
        steps=abilities.steps,
        command_resolution=abilities.command_resolution,
    )


def robot_driver(driver: str) -> type[RobotClass]:
    """Return the class of a robot's driver.

    Raises:
        ConfigError: no such driver is installed, or it is none of a robot.
    """
    try:
        return cast("type[RobotClass]", load_driver(driver, "robot"))
    except LookupError as error:
        raise ConfigError(f"[robot] driver: {error.args[0]}") from error


def may_move_an_arm(device: str, driver: str) -> bool:
    """Return whether bytes that are sent to a device of a cell file may move an arm."""
    return device == "robot" or (driver in driver_names() and load_driver(driver).role == "robot")
