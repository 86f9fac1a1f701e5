"""Joint-interpolated motion: all joints start and end together, with a trapezoidal speed."""

from dataclasses import dataclass

import numpy as np

from simulators.bench.types import Floats
from simulators.config import ArmDynamics, Joints


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


_SHORTEST = 1e-9
"""Ways (deg or mm) and times (s) of less than this count as none."""

STANDSTILL = Profile(0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Motion:
    """One motion of the arm and the rest that follows it.

    Attributes:
        start: joints at the start, deg, deg, mm, deg.
        end: joints at the end.
        start_s: bench time of the start, s.
        profile: speed along the way.
    """

    start: Joints
    end: Joints
    start_s: float
    profile: Profile

    @property
    def end_s(self) -> float:
        """Bench time of the standstill, s."""
        return self.start_s + self.profile.duration_s

    def joints_at(self, time_s: float) -> Joints:
        """Return the commanded joints at a bench time."""
        if time_s >= self.end_s:
            return self.end
        done = float(self.profile.fraction(np.array([time_s - self.start_s]))[0])
        j1, j2, j3, j4 = (a + done * (b - a) for a, b in zip(self.start, self.end, strict=True))
        return (j1, j2, j3, j4)


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
        start: joints at the start.
        end: joints at the end.
        start_s: bench time of the start, s.
        dynamics: largest speeds and accelerations.
        speed_fraction: part of the largest speeds to use, 0...1.
        acceleration_fraction: part of the largest accelerations to use, 0...1.
    """
    spans = [abs(b - a) for a, b in zip(start, end, strict=True)]
    if max(spans) < _SHORTEST:
        return Motion(start, end, start_s, STANDSTILL)
    speed = min(v * speed_fraction / d for v, d in zip(dynamics.max_speed, spans, strict=True) if d)
    limits = zip(dynamics.max_acceleration, spans, strict=True)
    acceleration = min(a * acceleration_fraction / d for a, d in limits if d)
    speed = min(speed, acceleration**0.5)
    ramp_s = speed / acceleration
    return Motion(start, end, start_s, Profile(speed, ramp_s, max(0.0, 1.0 / speed - ramp_s), ramp_s))


def plan_stop(motion: Motion, time_s: float, dynamics: ArmDynamics) -> Motion:
    """Return the deceleration that ends a motion on its own path as soon as the drives can.

    Args:
        motion: the motion under way.
        time_s: bench time of the stop, s.
        dynamics: largest accelerations.
    """
    here = motion.joints_at(time_s)
    speed = motion.profile.speed_at(time_s - motion.start_s)
    spans = [b - a for a, b in zip(motion.start, motion.end, strict=True)]
    limits = zip(dynamics.max_acceleration, spans, strict=True)
    brake_s = speed * max(abs(d) / a for a, d in limits)
    if brake_s < _SHORTEST:
        return Motion(here, here, time_s, STANDSTILL)
    way = 0.5 * speed * brake_s
    j1, j2, j3, j4 = (a + way * d for a, d in zip(here, spans, strict=True))
    return Motion(here, (j1, j2, j3, j4), time_s, Profile(2.0 / brake_s, 0.0, 0.0, brake_s))
