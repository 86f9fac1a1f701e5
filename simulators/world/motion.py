"""Motion in joint space: straight with a trapezoidal speed, through knots, blended, and its stop."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from catseye.simulators.config import ArmDynamics, Joints
from catseye.simulators.world.types import Floats, Ints


@dataclass(frozen=True)
class Profile:
    """Trapezoidal speed along a path of length 1.

    Attributes:
        speed: speed between the ramps, 1/s.
        rise_s: duration of the first ramp; 0 starts at full speed (a motion that is being stopped).
        flat_s: time at full speed.
        fall_s: duration of the last ramp.
    """

    speed: float
    rise_s: float
    flat_s: float
    fall_s: float

    @property
    def duration_s(self) -> float:
        """Time from start to standstill, s."""
        return self.rise_s + self.flat_s + self.fall_s

    def fraction(self, elapsed_s: Floats) -> Floats:
        """Return the travelled fraction of the path, 0...1, same shape.

        Args:
            elapsed_s: times since the start, s; beyond the end the fraction is 1.
        """
        rise = np.clip(elapsed_s, 0.0, self.rise_s)
        left = np.clip(self.duration_s - elapsed_s, 0.0, self.fall_s)
        flat = np.clip(elapsed_s - self.rise_s, 0.0, self.flat_s + self.fall_s)
        travelled = self.speed * (flat + rise * rise * _half_inverse(self.rise_s))
        falling = self.fall_s - left
        travelled -= self.speed * falling * falling * _half_inverse(self.fall_s)
        return np.minimum(travelled, 1.0, out=travelled)

    def speed_at(self, elapsed_s: float) -> float:
        """Return the speed, 1/s, at a time since the start."""
        if not 0.0 <= elapsed_s < self.duration_s:
            return 0.0
        rising = elapsed_s / self.rise_s if elapsed_s < self.rise_s else 1.0
        left_s = self.duration_s - elapsed_s
        falling = left_s / self.fall_s if left_s < self.fall_s else 1.0
        return self.speed * min(rising, falling)


def _half_inverse(ramp_s: float) -> float:
    return 0.5 / ramp_s if ramp_s > 0.0 else 0.0


SHORTEST = 1e-9
"""Ways (deg or mm) and times (s) of less than this count as none."""

STANDSTILL = Profile(0.0, 0.0, 0.0, 0.0)

_ENDS = np.array([0.0, 1.0])
_RAMP_STEP_S = 0.001
"""Speed ramps of a blended way are drawn in straight pieces of this duration."""


@dataclass(frozen=True)
class Motion:
    """One motion of the arm along straight legs in joint space, and the rest that follows it.

    Attributes:
        knots: joints at the ends of the legs, deg or mm, shape (m, n).
        marks: fraction of the way at which each knot is passed, 0...1, increasing, shape (m,).
        start_s: bench time of the start, s.
        profile: speed along the way.
    """

    knots: Floats
    marks: Floats
    start_s: float
    profile: Profile

    @classmethod
    def straight(cls, start: Joints, end: Joints, start_s: float, profile: Profile) -> "Motion":
        """Return the motion along one leg."""
        return cls(np.array([start, end], dtype=np.float64), _ENDS, start_s, profile)

    @property
    def start(self) -> Joints:
        """Joints at the start, deg or mm."""
        return _joints(self.knots[0])

    @property
    def end(self) -> Joints:
        """Joints at the standstill, deg or mm."""
        return _joints(self.knots[-1])

    @property
    def end_s(self) -> float:
        """Bench time of the standstill, s."""
        return self.start_s + self.profile.duration_s

    @cached_property
    def steps(self) -> Floats:
        """Joint travel of each leg, shape (m - 1, n)."""
        return np.diff(self.knots, axis=0)

    @cached_property
    def _spans(self) -> Floats:
        return np.diff(self.marks)

    @cached_property
    def slopes(self) -> Floats:
        """Joint travel of each leg in a unit of the way, shape (m - 1, n)."""
        slopes: Floats = self.steps / self._spans[:, None]
        return slopes

    def done(self, time_s: Floats) -> Floats:
        """Return the travelled fraction of the way at bench times, same shape."""
        if self.profile.duration_s == 0.0:
            return np.ones_like(time_s)
        return self.profile.fraction(time_s - self.start_s)

    def legs(self, done: Floats) -> tuple[Ints, Floats]:
        """Return the leg and the travelled part of it at fractions of the way; beyond 1 the last goes on."""
        leg = np.searchsorted(self.marks[1:-1], done, side="right")
        return leg, (done - self.marks[leg]) / self._spans[leg]

    def along(self, done: Floats) -> Floats:
        """Return the joints at fractions of the way, a row a fraction."""
        leg, part = self.legs(done)
        joints: Floats = self.knots[leg] + part[:, None] * self.steps[leg]
        return joints

    def joints_at(self, time_s: float) -> Joints:
        """Return the commanded joints at a bench time."""
        if time_s >= self.end_s:
            return self.end
        return _joints(self.along(self.done(np.array([time_s])))[0])

    def slopes_from(self, done: float) -> Floats:
        """Return the joint travels in a unit of the way on the legs that are still to go, shape (k, n)."""
        first = int(self.legs(np.array([done]))[0][0])
        return self.slopes[first:]

    def part(self, first: float, last: float) -> tuple[Floats, Floats]:
        """Return the knots and marks of a part of the way, given by fractions; beyond 1 the last leg goes on."""
        inner = self.marks[1:-1]
        cuts = np.concatenate([[first], inner[(inner > first) & (inner < last)], [last]])
        return self.along(cuts), (cuts - first) / (last - first)


def _joints(row: Floats) -> Joints:
    return tuple(row.tolist())


def plan_motion(
    start: Joints,
    end: Joints,
    start_s: float,
    dynamics: ArmDynamics,
    speed_fraction: float = 1.0,
    acceleration_fraction: float = 1.0,
) -> Motion:
    """Return the motion between two poses; the joint that needs longest sets the pace.

    Args:
        start_s: bench time of the start, s.
        speed_fraction: part of the largest speeds to use, 0...1.
        acceleration_fraction: part of the largest accelerations to use, 0...1.
    """
    spans = [abs(b - a) for a, b in zip(start, end, strict=True)]
    if max(spans) < SHORTEST:
        return Motion.straight(start, end, start_s, STANDSTILL)
    speed = min(v * speed_fraction / d for v, d in zip(dynamics.max_speed, spans, strict=True) if d)
    limits = zip(dynamics.max_acceleration, spans, strict=True)
    acceleration = min(a * acceleration_fraction / d for a, d in limits if d)
    speed = min(speed, acceleration**0.5)
    ramp_s = speed / acceleration
    profile = Profile(speed, ramp_s, max(0.0, 1.0 / speed - ramp_s), ramp_s)
    return Motion.straight(start, end, start_s, profile)


def plan_glide(start: Joints, end: Joints, start_s: float, duration_s: float) -> Motion:
    """Return the motion at constant speed that takes a given time."""
    return Motion.straight(start, end, start_s, Profile(1.0 / duration_s, 0.0, duration_s, 0.0))


def plan_way(start: Joints, times_s: Floats, joints: Floats, start_s: float) -> Motion:
    """Return the motion through knots, straight and at constant speed from one to the next.

    Args:
        times_s: when each knot is passed, s after the start, above 0 and increasing, shape (m,).
        joints: knots, deg or mm, shape (m, n).
        start_s: bench time of the start, s.
    """
    duration_s = float(times_s[-1])
    marks = np.concatenate([[0.0], times_s / duration_s])
    knots = np.concatenate([[start], joints])
    return Motion(knots, marks, start_s, Profile(1.0 / duration_s, 0.0, duration_s, 0.0))


def blend(
    points: Sequence[Joints],
    dynamics: ArmDynamics,
    speed_fraction: float = 1.0,
) -> tuple[Floats, Floats]:
    """Return a way from the first point to the last that cuts the corners at those between.

    Each move begins when the one before begins to decelerate, later where its own ramp is the shorter one, so
    that two ramps together never exceed the speed of one. Never more than two moves overlap.

    Args:
        points: where the arm stands, via points, destination.
        speed_fraction: part of the largest speeds to use, 0...1.

    Returns:
        Times, s after the start, and joints, as `plan_way` takes them; both empty when there is no way to go.
    """
    moves: list[Motion] = []
    for start, end in pairwise(points):
        move = plan_motion(start, end, 0.0, dynamics, speed_fraction)
        if move.profile is not STANDSTILL:
            moves.append(replace(move, start_s=_blended_start_s(moves, move.profile)))
    if not moves:
        return np.empty(0), np.empty((0, len(points[0])))
    times_s = np.unique(np.concatenate([_ramp_times_s(move) for move in moves]))
    times_s = times_s[np.append(np.diff(times_s) > SHORTEST, True) & (times_s > SHORTEST)]
    joints = points[0] + sum(move.done(times_s)[:, None] * move.steps[0] for move in moves)
    return times_s, joints


def _blended_start_s(moves: list[Motion], profile: Profile) -> float:
    if not moves:
        return 0.0
    last = moves[-1]
    start_s = last.end_s - min(last.profile.fall_s, profile.rise_s)
    return max(start_s, moves[-2].end_s) if len(moves) > 1 else start_s


def _ramp_times_s(move: Motion) -> Floats:
    """Return times between which a move goes at constant speed, or nearly so."""
    profile = move.profile
    count = int(np.ceil(profile.rise_s / _RAMP_STEP_S)) + 1
    rise = np.linspace(0.0, profile.rise_s, count)
    fall = np.linspace(profile.rise_s + profile.flat_s, profile.duration_s, count)
    return move.start_s + np.concatenate([rise, fall])


def plan_stop(motion: Motion, time_s: float, dynamics: ArmDynamics) -> Motion:
    """Return the deceleration that ends a motion on its own way as soon as the drives can.

    Where the way is shorter than the brakes need, its last leg goes straight on.

    Args:
        time_s: bench time of the stop, s.
    """
    here = motion.joints_at(time_s)
    elapsed_s = time_s - motion.start_s
    done = float(motion.done(np.array([time_s]))[0])
    speed = motion.profile.speed_at(elapsed_s)
    slopes = np.abs(motion.slopes_from(done))
    brake_s = speed * float(np.max(slopes / np.array(dynamics.max_acceleration)))
    if brake_s < SHORTEST:
        return Motion.straight(here, here, time_s, STANDSTILL)
    knots, marks = motion.part(done, done + 0.5 * speed * brake_s)
    return Motion(knots, marks, time_s, Profile(2.0 / brake_s, 0.0, 0.0, brake_s))
