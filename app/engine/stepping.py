"""Relative motions before they are sent: how far they may take the arm at most, and how the driver is asked.

Increments are added to the measured joint position, as the resolution test of joints demands (resolution paper,
section 3.4). A controller does that itself where its driver can have it done. Where it cannot, the program adds the
increment to the position that the controller reports and commands the sum, rounded to what the controller can
command: the smallest such step is the controller's command resolution.
"""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Final

from catseye.app.errors import LimitError
from catseye.drivers.roles.pose import SYMBOLS, Axes, Pose, Unit, pose_text, with_axis
from catseye.drivers.roles.robot import Robot
from catseye.procedures.kit.motion.steps import MOST, Vector, axis_target, largest_change, length_mm

LineTarget = Callable[[Pose, Vector], Pose]
"""Returns the joints after a straight shift of the tool in the base frame, from given joints."""

BEYOND: Final = 0.1
"""A relative motion ends near a place and not at it: the gate clears so much more of the way, deg or mm. What the
controller measures and what it reports differ by far less."""


@dataclass(frozen=True)
class Step:
    """A relative motion that is to be sent.

    Attributes:
        text: for people.
        farthest: returns where it ends at worst, from the measured joints.
        commanded: returns the increment that can be commanded from there, deg or mm.
        send: sends that increment.
    """

    text: str
    farthest: Callable[[Pose], Pose]
    commanded: Callable[[Pose], float]
    send: Callable[[Pose, float], Awaitable[None]]


def axis_step(robot: Robot, axes: Axes, axis: str, increment: float) -> Step:
    """Return a step of one axis.

    Raises:
        LimitError: it is larger than any step may be.
        ValueError: the arm has no such axis.
    """
    number = [each.name for each in axes].index(axis)
    unit = axes[number].unit
    _require_small(f"a step of {axis}", increment, unit)
    beyond = BEYOND if increment > 0.0 else -BEYOND

    def farthest(here: Pose) -> Pose:
        return axis_target(axes, here, axis, increment + beyond)

    def as_resolved(here: Pose) -> float:
        resolution = (robot.abilities.command_resolution or {}).get(unit)
        return rounded(here[number] + increment, resolution) - here[number]

    async def by_controller(here: Pose, commanded: float) -> None:
        del here
        await robot.step_axis(axis, commanded)

    async def by_program(here: Pose, commanded: float) -> None:
        await robot.move_joints(with_axis(here, number, here[number] + commanded))

    text = f"{axis} by {increment:+g}{SYMBOLS[unit]}"
    if robot.abilities.steps:
        return Step(text, farthest, lambda _here: increment, by_controller)
    return Step(text, farthest, as_resolved, by_program)


def pose_step(robot: Robot, axes: Axes, target: Pose) -> Step:
    """Return a step to a pose; the gate refuses it where the arm stands farther off than a step is."""

    def commanded(here: Pose) -> float:
        return largest_change(here, target)

    def farthest(here: Pose) -> Pose:
        for axis, at, to in zip(axes, here, target, strict=True):
            _require_small(f"a step of {axis.name}", to - at, axis.unit)
        return target

    async def send(here: Pose, increment: float) -> None:
        del here, increment
        await robot.step_to(target)

    return Step(f"the arm to {pose_text(axes, target)}", farthest, commanded, send)


def line_step(robot: Robot, line_target: LineTarget, increment_mm: Vector) -> Step:
    """Return a straight step of the tool.

    Raises:
        LimitError: it is larger than any step may be.
    """
    size_mm = length_mm(increment_mm)
    _require_small("a straight step", size_mm, "mm")
    share = (size_mm + BEYOND) / size_mm if size_mm else 1.0
    x_mm, y_mm, z_mm = increment_mm

    def farthest(here: Pose) -> Pose:
        return line_target(here, (share * x_mm, share * y_mm, share * z_mm))

    async def by_controller(here: Pose, commanded_mm: float) -> None:
        del here, commanded_mm
        await robot.step_line(increment_mm)

    text = f"the tool by ({x_mm:g}, {y_mm:g}, {z_mm:g}) mm"
    return Step(text, farthest, lambda _here: size_mm, by_controller)


def rounded(value: float, resolution: float | None) -> float:
    """Return what a controller takes a value for; any value where it resolves all."""
    return value if resolution is None else round(value / resolution) * resolution


def _require_small(what: str, increment: float, unit: Unit) -> None:
    # Written so that what is not a number is refused too.
    if not abs(increment) <= MOST[unit]:
        raise LimitError(
            f"{what} by {increment:g}{SYMBOLS[unit]} is refused: a relative motion is at most {MOST[unit]:g}"
            f"{SYMBOLS[unit]}; drive to a pose instead"
        )
