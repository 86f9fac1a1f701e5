"""Joint and position values: constants of the language, answers on the wire, the arm's nominal geometry."""

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from catseye.calibration.scara.errors import OutOfReachError
from catseye.calibration.scara.planar import Hand, forward, inverse
from catseye.simulators.config import EmulationConfig, Joints
from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.world.types import Bools

RIGHT = 4
"""Bit of the first posture flag: right-handed arm, J2 >= 0."""

_NUMBER = re.compile(r"[+-]?(\d+(?:\.\d*)?|\.\d+)(E[+-]?\d{1,2})?", re.IGNORECASE)
_ROUNDING = 1e-9
LARGEST = 1e9
"""Largest size of a number of the language."""

_JOINT_NAMES = tuple(f"J{n}" for n in range(1, 9))
_POSITION_NAMES = {4: ("X", "Y", "Z", "C"), 6: tuple("XYZABC"), 8: (*tuple("XYZABC"), "L1", "L2")}


@dataclass(frozen=True)
class Position:
    """Cartesian position of the tool, nominal.

    Attributes:
        x_mm: mm.
        y_mm: mm.
        z_mm: height, the same as J3, mm.
        c_deg: direction of the tool, deg.
        flag1: posture, bit RIGHT.
        flag2: turn counts; kept, not used.
    """

    x_mm: float
    y_mm: float
    z_mm: float
    c_deg: float
    flag1: int
    flag2: int = 0


Variable = Joints | Position | float
"""Value of a variable of the language: J…, P… or M…."""


def value_text(value: Variable) -> str:
    """Return a value as a variable read shows it, signed, with two decimals for joints and positions."""
    if isinstance(value, Position):
        places = (value.x_mm, value.y_mm, value.z_mm, 0.0, 0.0, value.c_deg)
        return f"({','.join(f'{place:+.2f}' for place in places)})({flags_text(value)})"
    if isinstance(value, tuple):
        return f"({','.join(f'{joint:+.2f}' for joint in value)})"
    return f"{value:+g}"


def number(text: str) -> float:
    """Return a numeric constant; an empty place of a list counts as 0."""
    stripped = text.strip()
    if not stripped:
        return 0.0
    if _NUMBER.fullmatch(stripped) is None:
        raise Refusal(alarms.SYNTAX)
    value = float(stripped)
    if abs(value) > LARGEST:
        raise Refusal(alarms.OUT_OF_RANGE)
    return value


def joint_constant(values: str) -> Joints:
    """Return the joints of a list `a,b,c,d[,…]`; axes beyond the fourth do not exist here."""
    parts = [number(part) for part in values.split(",")]
    if not 1 <= len(parts) <= 8:
        raise Refusal(alarms.SYNTAX)
    j1, j2, j3, j4 = (parts + [0.0] * 4)[:4]
    return (j1, j2, j3, j4)


def position_constant(values: str, flags: str | None, default_flag: int) -> Position:
    """Return the position of lists `x,y,z,a,b,c[,…]` and `fl1,fl2`; A and B do not exist here."""
    parts = [number(part) for part in values.split(",")]
    if not 1 <= len(parts) <= 8:
        raise Refusal(alarms.SYNTAX)
    x_mm, y_mm, z_mm, _a, _b, c_deg = (parts + [0.0] * 6)[:6]
    if flags is None:
        return Position(x_mm, y_mm, z_mm, c_deg, default_flag)
    flag1, flag2 = [*(int(number(part)) for part in flags.split(",")), 0, 0][:2]
    return Position(x_mm, y_mm, z_mm, c_deg, flag1, flag2)


def rounded(joints: Joints) -> Joints:
    """Return a target on the controller's step of 1 mdeg (and 1 µm for J3; SCARA paper, robot data)."""
    j1, j2, j3, j4 = (round(value, 3) for value in joints)
    return (j1, j2, j3, j4)


def within_limits(joints: ArrayLike, config: EmulationConfig) -> Bools:
    """Return whether joints, shape (…, 4), are within the limits of the arm, shape (…)."""
    low, high = np.array(config.limits).T
    values = np.asarray(joints, dtype=np.float64)
    return np.asarray(np.all((values >= low - _ROUNDING) & (values <= high + _ROUNDING), axis=-1))


def position_of(joints: Joints, config: EmulationConfig) -> Position:
    """Return the nominal position of joints."""
    j1, j2, j3, j4 = joints
    angles = (np.array(np.deg2rad(j1)), np.array(np.deg2rad(j2)))
    x_mm, y_mm = forward(*angles, config.scara.link1_mm, config.scara.link2_mm)
    c_deg = 180.0 - (180.0 - (j1 + j2 + j4)) % 360.0
    return Position(float(x_mm), float(y_mm), j3, c_deg, RIGHT if j2 >= 0.0 else 0)


def joints_of(position: Position, near: Joints, config: EmulationConfig) -> Joints:
    """Return the joints of a nominal position, J4 on the branch nearest to a pose.

    Raises:
        Refusal: the position is out of reach.
    """
    hand: Hand = "right" if position.flag1 & RIGHT else "left"
    xy = np.array([position.x_mm, position.y_mm])
    try:
        theta1, theta2 = inverse(xy, config.scara.link1_mm, config.scara.link2_mm, hand)
    except OutOfReachError:
        raise Refusal(alarms.NO_SOLUTION) from None
    j1, j2 = float(np.rad2deg(theta1)), float(np.rad2deg(theta2))
    j4 = position.c_deg - j1 - j2
    turns = [j4 + 360.0 * n for n in range(-3, 4)]
    lowest, highest = config.limits[3]
    inside = [turn for turn in turns if lowest <= turn <= highest]
    return (j1, j2, position.z_mm, min(inside or turns, key=lambda turn: abs(turn - near[3])))


def joint_pairs(joints: Joints, axes: int) -> list[tuple[str, float]]:
    """Return the named values of a joint answer; axes that do not exist read 0."""
    values = [*joints, *[0.0] * (axes - 4)]
    return list(zip(_JOINT_NAMES[:axes], values, strict=True))


def position_pairs(position: Position, axes: int) -> list[tuple[str, float]]:
    """Return the named values of a position answer."""
    known = {"X": position.x_mm, "Y": position.y_mm, "Z": position.z_mm, "C": position.c_deg}
    return [(name, known.get(name, 0.0)) for name in _POSITION_NAMES[axes]]


def flags_text(position: Position) -> str:
    """Return the posture flags as they stand in answers."""
    return f"{position.flag1},{position.flag2}"
