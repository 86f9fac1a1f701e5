"""The arm as the dry run sees it: where it passes, how fast, and what the beam meets.

Geometry of its own: it looks at a plan from outside and would not see the planner's mistakes with the planner's eyes.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.bench import Arm, Bench, Reflector

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

_SAMPLE_STEP = 0.25
"""Largest change of a joint from one sample to the next, deg or mm."""

_FEWEST_SAMPLES = 8
"""Of a leg: between two sub-steps the miss is a bow, and its top must not fall between samples."""


@dataclass(frozen=True)
class Hit:
    """A reflector that returns the beam.

    Attributes:
        reflector: which one.
        length_mm: length of the beam.
    """

    reflector: Reflector
    length_mm: float


@dataclass(frozen=True)
class Speeds:
    """The fastest that a way is driven.

    Attributes:
        joint_deg_s: fastest joint of J1, J2 and J4, deg/s.
        tool_mm_s: the J4 axis in the plane, mm/s.
    """

    joint_deg_s: float
    tool_mm_s: float

    def faster(self, other: "Speeds") -> "Speeds":
        """Return the larger of each."""
        return Speeds(max(self.joint_deg_s, other.joint_deg_s), max(self.tool_mm_s, other.tool_mm_s))


AT_REST = Speeds(0.0, 0.0)


class ArmModel:
    """An ideal arm with a beam.

    Args:
        bench: links, optics and places, as well as they are known.
    """

    def __init__(self, bench: Bench) -> None:
        self._bench = bench

    def hit(self, pose: Pose) -> Hit | None:
        """Return the nearest reflector that returns the beam at a pose."""
        poses = np.array([pose], dtype=np.float64)
        hits = [
            Hit(one, self._along_mm(poses, one))
            for one in self._bench.reflectors
            if bool(self.returns(poses, one)[0])
        ]
        return min(hits, key=lambda hit: hit.length_mm, default=None)

    def sampled(self, start: Pose, way: Sequence[Pose]) -> Floats:
        """Return poses along straight joint moves through targets, start and targets included, shape (n, 4)."""
        stops = np.array([start, *way], dtype=np.float64)
        steps = np.diff(stops, axis=0)
        count = max(_FEWEST_SAMPLES, math.ceil(float(np.abs(steps).max()) / _SAMPLE_STEP))
        share = np.arange(1, count + 1) / count
        between = stops[:-1, None, :] + share[None, :, None] * steps[:, None, :]
        return np.vstack([stops[:1], between.reshape(-1, 4)])

    def miss_mm(self, poses: Floats, reflector: Reflector) -> Floats:
        """Return the distance of a reflector's centre from the beam, mm, shape (n,).

        The beam begins at the J4 axis: a reflector behind it is as far away as the axis. It is level, and at the
        reflectors' height where J3 stands as the cell file has it.
        """
        dx, dy, world = self._sight(poses, reflector)
        ahead = dx * np.cos(world) + dy * np.sin(world)
        aside = dy * np.cos(world) - dx * np.sin(world)
        above = poses[:, 2] - self._bench.arm.j3_mm
        return np.where(ahead > 0.0, np.hypot(aside, above), np.hypot(dx, dy))

    def returns(self, poses: Floats, reflector: Reflector) -> Bools:
        """Return at which poses a reflector returns the beam, past the column and inside its field, shape (n,)."""
        optics = self._bench.optics
        dx, dy, _ = self._sight(poses, reflector)
        back_deg = np.rad2deg(np.arctan2(-dy, -dx))
        off_deg = np.abs((back_deg - reflector.facing_deg + 180.0) % 360.0 - 180.0)
        free = self._column_gap_mm(poses, dx, dy) > optics.column_radius_mm
        hit = self.miss_mm(poses, reflector) <= optics.acceptance_mm
        return np.asarray(hit & free & (off_deg <= optics.field_half_angle_deg), dtype=np.bool_)

    def speeds(self, start: Pose, way: Sequence[Pose]) -> Speeds:
        """Return the fastest that a way is driven."""
        legs = np.array([start, *way], dtype=np.float64)
        travel = np.abs(np.diff(legs, axis=0))[:, [0, 1, 3]]
        rate = _leg_rates(self._bench.arm, travel)
        joint = float((travel * rate[:, None]).max())
        return Speeds(joint, self._tool_mm_s(start, way, rate))

    def _along_mm(self, poses: Floats, reflector: Reflector) -> float:
        """Return the length of the beam at the first pose, measured along it as a counter does."""
        dx, dy, world = self._sight(poses, reflector)
        return float(dx[0] * np.cos(world[0]) + dy[0] * np.sin(world[0]))

    def _tool_mm_s(self, start: Pose, way: Sequence[Pose], rate: Floats) -> float:
        poses = self.sampled(start, way)
        chords = np.hypot(*np.diff(np.stack(self._xy(poses)), axis=1)).reshape(len(way), -1)
        return float((chords * chords.shape[1] * rate[:, None]).max())

    def _xy(self, poses: Floats) -> tuple[Floats, Floats]:
        arm, one, both = self._bench.arm, np.deg2rad(poses[:, 0]), np.deg2rad(poses[:, 0] + poses[:, 1])
        x = arm.link1_mm * np.cos(one) + arm.link2_mm * np.cos(both)
        y = arm.link1_mm * np.sin(one) + arm.link2_mm * np.sin(both)
        return x, y

    def _sight(self, poses: Floats, reflector: Reflector) -> tuple[Floats, Floats, Floats]:
        """Return the way to a reflector, mm, and the beam's direction, rad, shape (n,) each."""
        x, y = self._xy(poses)
        world = np.deg2rad(poses[:, 0] + poses[:, 1] + poses[:, 3] + self._bench.optics.theta40_deg)
        return reflector.x_mm - x, reflector.y_mm - y, world

    def _column_gap_mm(self, poses: Floats, dx: Floats, dy: Floats) -> Floats:
        """Return how near the line from arm to reflector comes to the J1 axis, mm, shape (n,)."""
        x, y = self._xy(poses)
        share = np.clip(-(x * dx + y * dy) / np.maximum(dx**2 + dy**2, 1e-12), 0.0, 1.0)
        return np.asarray(np.hypot(x + share * dx, y + share * dy), dtype=np.float64)


def _leg_rates(arm: Arm, travel_deg: Floats) -> Floats:
    """Return how fast the legs of a way are driven at their fastest, legs in a second, shape (n,).

    Args:
        arm: speeds, accelerations, override and way of following.
        travel_deg: travel of J1, J2, J4 on each leg, deg, shape (n, 3).
    """
    speed = np.asarray(arm.speed_deg_s) * arm.override_percent / 100.0
    acceleration = np.asarray(arm.acceleration_deg_s2)
    if arm.following == "streamed":
        speed = np.minimum(speed, arm.follow_speed_deg_s)
        acceleration = np.full(3, arm.follow_acceleration_deg_s2 * 2.0 / np.pi)
    # A robot that passes its targets speeds up once for the whole way.
    run_up = travel_deg if arm.following == "stops" else np.tile(travel_deg.sum(axis=0), (len(travel_deg), 1))
    reached = np.minimum(speed, np.sqrt(run_up * acceleration))
    moving = travel_deg > 1e-9
    rates = np.where(moving, reached / np.where(moving, travel_deg, 1.0), np.inf).min(axis=1)
    return np.where(np.isfinite(rates), rates, 0.0)
