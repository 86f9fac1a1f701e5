"""Ways of a jog along axes of space (sheet, section 1.9: modes 01, 02, 04 and 05), as far as the arm can go.

The sheet names the modes and no more. A public client gives the axes of a telegram as bits: X, Y, Z, A, B, C. What
is assumed: along X, Y and Z the tool goes straight and keeps its direction (01 axes of BASE, 02 of the tool), and C
turns it where it stands; with 3-axis XYZ (04) J4 stays instead, and the bit of A turns it; the cylinder (05) stands
on the axis of J1, with the radius, the angle and the height in the places of X, Y and Z, and the tool turns with
the angle. Several axes at once share the speed of the tool. A hand of this arm does not tilt: other bits are left
out.
"""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from catseye.calibration.scara.errors import OutOfReachError
from catseye.calibration.scara.planar import Hand, inverse
from catseye.simulators.config import Joints
from catseye.simulators.melfa import paths
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.arm_control import ArmControl
from catseye.simulators.melfa.values import RIGHT, position_of, within_limits
from catseye.simulators.world.types import Floats

_LONGEST_MM, _LONGEST_DEG = 2000.0, 1500.0
"""Further than the arm can go."""

_HALVINGS = 24
_FIRST_PARTS = np.array([0.01, 0.03, 0.07, 0.15, 0.3, 0.6])
_X, _Y, _Z, _A, _B, _C = range(6)


class SpaceAxes(Enum):
    """Modes of JOG in which the tool goes along axes of space."""

    XYZ = 1
    TOOL = 2
    THREE_AXIS_XYZ = 4
    CYLINDER = 5

    @property
    def places(self) -> tuple[int, ...]:
        """Bits of the axes that this arm has."""
        return (_X, _Y, _Z, _A) if self is SpaceAxes.THREE_AXIS_XYZ else (_X, _Y, _Z, _C)


@dataclass(frozen=True)
class Rates:
    """How far the axes go while a jog advances by one.

    Attributes:
        x: mm; the radius of a cylinder.
        y: mm, or deg about the axis of a cylinder.
        z: mm.
        turn: of the tool, deg.
    """

    x: float
    y: float
    z: float
    turn: float


def even_rates(axes: SpaceAxes, directions: tuple[int, ...]) -> Rates:
    """Return rates of steps: each axis by as many mm or deg as the jog advances."""
    x, y, z, turn = (float(directions[place]) for place in axes.places)
    return Rates(x, y, z, turn)


def jog_rates(
    control: ArmControl, axes: SpaceAxes, directions: tuple[int, ...], speed_mm_s: float, turn_deg_s: float
) -> Rates:
    """Return rates of a jog that advances by its seconds: one speed of the tool, shared by the axes."""
    x, y, z, turn = (float(directions[place]) for place in axes.places)
    speed = speed_mm_s / max(1.0, float(np.linalg.norm([x, y, z])))
    radius_mm = float(np.hypot(*_flange(control)[:2]))
    around = np.rad2deg(1.0 / max(radius_mm, 1.0)) if axes is SpaceAxes.CYLINDER else 1.0
    return Rates(speed * x, speed * y * float(around), speed * z, turn_deg_s * turn)


def way_along(
    control: ArmControl, axes: SpaceAxes, rates: Rates, most: float = np.inf
) -> tuple[Floats, Floats]:
    """Return how far the jog has advanced at each knot and the joints there, without the start, shapes (n,), (n, 4).

    Args:
        most: how far it advances at most; otherwise to where the arm can go no further.
    """
    fastest = max(abs(rates.x), abs(rates.y), abs(rates.z), abs(rates.turn))
    steps = _advances(rates, most, 1.0 / fastest)
    possible, beyond = 0, len(steps) + 1
    while beyond - possible > 1:
        middle = (possible + beyond) // 2
        if _joints(control, axes, rates, steps[:middle]) is None:
            beyond = middle
        else:
            possible = middle
    good: Floats = steps[:possible]
    if possible < len(steps):
        good = _up_to_the_end(control, axes, rates, good, float(steps[possible]))
    joints = _joints(control, axes, rates, good)
    if joints is None or not good.size:
        return np.empty(0), np.empty((0, 4))
    return good, joints


def _advances(rates: Rates, most: float, step: float) -> Floats:
    straight = max(abs(rates.x), abs(rates.z))
    about = max(abs(rates.y), abs(rates.turn))
    ends = [longest / rate for longest, rate in ((_LONGEST_MM, straight), (_LONGEST_DEG, about)) if rate]
    last = min(most, *ends)
    count = max(1, int(np.ceil(last / step)))
    # The first step is divided: the speed ramps up in it.
    parts = np.concatenate([_FIRST_PARTS, np.arange(1, count + 1)])
    return np.asarray(parts * (last / count), dtype=np.float64)


def _up_to_the_end(
    control: ArmControl, axes: SpaceAxes, rates: Rates, good: Floats, too_far: float
) -> Floats:
    """Return the knots with a last one at the very end of what the arm can do."""
    start = float(good[-1]) if good.size else 0.0
    reached = _joints(control, axes, rates, good)
    near = control.arm.joints if reached is None or not good.size else _row(reached[-1])
    low, high = start, too_far
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if _joints(control, axes, rates, np.array([middle]), near) is None:
            high = middle
        else:
            low = middle
    # A knot that is hardly any way from the one before would take no time.
    return np.append(good, low) if low - start > 1e-6 * (too_far - start) else good


def _flange(control: ArmControl) -> Floats:
    place = position_of(control.arm.joints, control.config)
    return np.array([place.x_mm, place.y_mm, place.z_mm, place.c_deg])


def _row(joints: Floats) -> Joints:
    j1, j2, j3, j4 = joints.tolist()
    return (j1, j2, j3, j4)


def _joints(
    control: ArmControl, axes: SpaceAxes, rates: Rates, advanced: Floats, near: Joints | None = None
) -> Floats | None:
    """Return the joints where the jog has advanced so far; None where the arm cannot go all of it.

    Args:
        near: joints a small step before the first; by default those of the arm.
    """
    if not advanced.size:
        return np.empty((0, 4))
    here = control.arm.joints
    near = near or here
    try:
        if axes is SpaceAxes.THREE_AXIS_XYZ:
            turned = here[3] + rates.turn * advanced
            return _with_j4(control, _straight(control, rates, advanced), turned, near[0])
        flanges = (
            _around(_flange(control), rates, advanced)
            if axes is SpaceAxes.CYLINDER
            else _straight(control, rates, advanced, of_tool=axes is SpaceAxes.TOOL, turns=True)
        )
        return paths.joints_along(flanges, near, control.position().flag1, control.config)
    except (Refusal, OutOfReachError):
        return None


def _straight(
    control: ArmControl, rates: Rates, advanced: Floats, *, of_tool: bool = False, turns: bool = False
) -> Floats:
    """Return the places of the flange while the tool goes straight."""
    place = control.position()
    angle = np.deg2rad(place.c_deg) if of_tool else 0.0
    cosine, sine = np.cos(angle), np.sin(angle)
    tools = np.column_stack(
        [
            place.x_mm + advanced * (cosine * rates.x - sine * rates.y),
            place.y_mm + advanced * (sine * rates.x + cosine * rates.y),
            place.z_mm + advanced * rates.z,
            place.c_deg + advanced * (rates.turn if turns else 0.0),
        ]
    )
    return control.frames.flanges(tools)


def _around(flange: Floats, rates: Rates, advanced: Floats) -> Floats:
    """Return the places of the flange on a cylinder about the axis of J1."""
    x_mm, y_mm, z_mm, c_deg = flange.tolist()
    radius = np.hypot(x_mm, y_mm) + advanced * rates.x
    angle = np.arctan2(y_mm, x_mm) + np.deg2rad(advanced * rates.y)
    return np.column_stack(
        [
            radius * np.cos(angle),
            radius * np.sin(angle),
            z_mm + advanced * rates.z,
            c_deg + advanced * (rates.y + rates.turn),
        ]
    )


def _with_j4(control: ArmControl, flanges: Floats, j4: Floats, j1_before: float) -> Floats | None:
    """Return the joints that bring the flange there while J4 takes a given angle; None beyond the limits."""
    scara = control.config.scara
    hand: Hand = "right" if control.position().flag1 & RIGHT else "left"
    theta1, theta2 = inverse(flanges[:, :2], scara.link1_mm, scara.link2_mm, hand)
    j1 = np.unwrap(np.concatenate([[j1_before], np.rad2deg(theta1)]), period=360.0)[1:]
    joints = np.column_stack([j1, np.rad2deg(theta2), flanges[:, 2], j4])
    return joints if within_limits(joints, control.config).all() else None
