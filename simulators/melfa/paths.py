"""Straight and circular motions: a way of the tool in space, and when the arm is where on it.

No source says how a controller ramps such motions, or what it does where a joint would be too fast: here the speed is
that of SPD, or as much of it as every joint can follow, with one ramp up and one down for each section.
"""

from collections.abc import Sequence

import numpy as np

from catseye.calibration.scara.errors import OutOfReachError
from catseye.calibration.scara.planar import Hand, inverse
from catseye.simulators.config import EmulationConfig, Joints
from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.values import RIGHT, Position, within_limits
from catseye.simulators.world.types import Floats

_STEP = 1.0
"""Between knots, mm, and deg of turning: the chord of the joints between two is off the way by a micrometre at most.
A tool of 100 mm that turns adds 4 µm."""

_STRAIGHT = 1e-9


def line(start: Position, end: Position) -> Floats:
    """Return a straight way: x, y, z in mm and the tool's direction in deg, shape (n, 4), without its start."""
    first, last = _places(start, end)
    share = _shares(float(np.linalg.norm(last[:3] - first[:3])), last[3] - first[3])
    return np.asarray(first + share[:, None] * (last - first), dtype=np.float64)


def arc(start: Position, via: Position, end: Position) -> Floats:
    """Return a circular way through a place to an end, without its start; likewise.

    Raises:
        Refusal: the three places lie on a line.
    """
    first, last = _places(start, end)
    middle, radius, across, angle = _circle(start, via, end)
    share = _shares(radius * angle, last[3] - first[3])
    turned = first[3] + share * (last[3] - first[3])
    return np.column_stack([_on_circle(middle, across, radius, share * angle), turned])


def circle(start: Position, first: Position, second: Position) -> Floats:
    """Return a whole circle through two places back to its start; the tool keeps its direction.

    Raises:
        Refusal: the three places lie on a line.
    """
    middle, radius, across, _ = _circle(start, first, second)
    share = _shares(2.0 * np.pi * radius)
    places = _on_circle(middle, across, radius, share * 2.0 * np.pi)
    return np.column_stack([places, np.full(share.size, start.c_deg)])


def joints_along(way: Floats, start: Joints, flag1: int, config: EmulationConfig) -> Floats:
    """Return the joints at the places of a way, J4 turning on from where it is, shape (n, 4).

    Raises:
        Refusal: a place is out of reach or outside the joint limits.
    """
    hand: Hand = "right" if flag1 & RIGHT else "left"
    try:
        theta1, theta2 = inverse(way[:, :2], config.scara.link1_mm, config.scara.link2_mm, hand)
    except OutOfReachError:
        raise Refusal(alarms.NO_SOLUTION) from None
    j1, j2 = np.rad2deg(theta1), np.rad2deg(theta2)
    j1 = np.unwrap(np.concatenate([[start[0]], j1]), period=360.0)[1:]
    j4 = np.unwrap(np.concatenate([[start[3]], way[:, 3] - j1 - j2]), period=360.0)[1:]
    joints = np.column_stack([j1, j2, way[:, 2], j4])
    inside = within_limits(joints, config)
    if not inside.all():
        raise Refusal(alarms.VIA_OUT_OF_RANGE if inside[-1] else alarms.DESTINATION_OUT_OF_RANGE)
    return joints


def passing_times_s(
    way_mm: Floats, joints: Floats, speed_mm_s: float, acceleration_mm_s2: float, max_speed: Sequence[float]
) -> Floats:
    """Return when each place is passed, s from the start.

    Args:
        way_mm: x, y, z with the start, shape (n + 1, 3).
        joints: likewise, shape (n + 1, 4).
        speed_mm_s: of the tool's end.
        max_speed: of each joint, deg/s or mm/s.
    """
    steps_mm = np.linalg.norm(np.diff(way_mm, axis=0), axis=1)
    slowest_s = np.max(np.abs(np.diff(joints, axis=0)) / np.asarray(max_speed), axis=1)
    with np.errstate(divide="ignore"):
        possible = float(np.min(np.where(slowest_s > 0.0, steps_mm / slowest_s, np.inf)))
    length_mm = float(steps_mm.sum())
    speed = min(speed_mm_s, possible, float(np.sqrt(acceleration_mm_s2 * length_mm)))
    ramp_mm = speed**2 / (2.0 * acceleration_mm_s2)
    gone_mm = np.cumsum(steps_mm)
    left_mm = np.maximum(length_mm - gone_mm, 0.0)
    whole_s = length_mm / speed + speed / acceleration_mm_s2
    even_s = gone_mm / speed + speed / (2.0 * acceleration_mm_s2)
    up_s = np.sqrt(2.0 * gone_mm / acceleration_mm_s2)
    down_s = whole_s - np.sqrt(2.0 * left_mm / acceleration_mm_s2)
    return np.where(gone_mm < ramp_mm, up_s, np.where(left_mm < ramp_mm, down_s, even_s))


def jogging_times_s(
    advanced: Floats, joints: Floats, speed: float, acceleration: float, max_speed: Sequence[float]
) -> Floats:
    """Return when each knot of a jog is passed, s from the start: fast where the joints can, slow where they cannot.

    Args:
        advanced: how far the jog is at each knot, with the start, increasing, shape (n + 1,).
        joints: likewise, shape (n + 1, 4).
        speed: of advancing.
        acceleration: likewise.
        max_speed: of each joint, deg/s or mm/s.
    """
    steps = np.diff(advanced)
    slowest_s = np.max(np.abs(np.diff(joints, axis=0)) / np.asarray(max_speed), axis=1)
    with np.errstate(divide="ignore"):
        possible = np.minimum(speed, np.where(slowest_s > 0.0, steps / slowest_s, np.inf))
    # Passed no faster than both neighbouring steps permit, at rest at both ends.
    passing = np.concatenate([[0.0], np.minimum(possible[1:], possible[:-1]), [0.0]])
    gains = 2.0 * acceleration * steps
    for n, gain in enumerate(gains):
        passing[n + 1] = min(passing[n + 1], float(np.sqrt(passing[n] ** 2 + gain)))
    for n in range(len(gains) - 1, -1, -1):
        passing[n] = min(passing[n], float(np.sqrt(passing[n + 1] ** 2 + gains[n])))
    mean = 0.5 * (passing[1:] + passing[:-1])
    # A single step rests at both ends: half of what its ramps reach.
    alone = np.minimum(possible, np.sqrt(acceleration * steps)) / 2.0
    return np.asarray(np.cumsum(steps / np.where(mean > 0.0, mean, alone)), dtype=np.float64)


def _places(start: Position, end: Position) -> tuple[Floats, Floats]:
    """Return start and end; the tool turns the shorter way."""
    turn = (end.c_deg - start.c_deg + 180.0) % 360.0 - 180.0
    first = np.array([start.x_mm, start.y_mm, start.z_mm, start.c_deg])
    return first, np.array([end.x_mm, end.y_mm, end.z_mm, start.c_deg + turn])


def _shares(length_mm: float, turn_deg: float = 0.0) -> Floats:
    count = max(1, int(np.ceil(max(length_mm, abs(turn_deg)) / _STEP)))
    return np.arange(1, count + 1) / count


def _circle(
    start: Position, via: Position, end: Position
) -> tuple[Floats, float, tuple[Floats, Floats], float]:
    """Return middle, radius, two directions of the plane, and the angle of the end from the start, rad.

    Turning from the first direction to the second leads from the start through `via` to the end.
    """
    a, b, c = (np.array([one.x_mm, one.y_mm, one.z_mm]) for one in (start, via, end))
    u, v = b - a, c - a
    normal = np.cross(u, v)
    size = float(normal @ normal)
    if size <= _STRAIGHT * float(u @ u) * float(v @ v):
        raise Refusal(alarms.NO_SOLUTION)
    middle = a + (np.cross(normal, u) * (v @ v) + np.cross(v, normal) * (u @ u)) / (2.0 * size)
    radius = float(np.linalg.norm(a - middle))
    ahead = (a - middle) / radius
    beside = np.cross(normal / np.sqrt(size), ahead)
    angle = float(np.arctan2((c - middle) @ beside, (c - middle) @ ahead)) % (2.0 * np.pi)
    return middle, radius, (ahead, beside), angle


def _on_circle(middle: Floats, across: tuple[Floats, Floats], radius: float, angle: Floats) -> Floats:
    ahead, beside = across
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return np.asarray(middle + radius * (cosine * ahead + sine * beside), dtype=np.float64)
