"""How a way is driven between its targets: poses along it, and the fastest that it gets."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.motion.motion_time import leg_rates
from catseye.procedures.kit.system import System

Floats = NDArray[np.float64]

_SAMPLE_STEP: Final = 0.25
"""Largest change of an axis from one sample to the next, deg or mm."""

_FEWEST_SAMPLES: Final = 8
"""Of a leg: between two sub-steps the miss is a bow, and its top must not fall between samples."""


@dataclass(frozen=True)
class Speeds:
    """The fastest that a way is driven.

    Attributes:
        joint_deg_s: fastest revolute axis, deg/s.
        tool_mm_s: the tool, mm/s.
    """

    joint_deg_s: float
    tool_mm_s: float

    def faster(self, other: "Speeds") -> "Speeds":
        """Return the larger of each."""
        return Speeds(max(self.joint_deg_s, other.joint_deg_s), max(self.tool_mm_s, other.tool_mm_s))

    def slowed(self, share: float) -> "Speeds":
        """Return a share of each, all of it at most."""
        return Speeds(min(share, 1.0) * self.joint_deg_s, min(share, 1.0) * self.tool_mm_s)


AT_REST: Final = Speeds(0.0, 0.0)


def sampled(start: Pose, way: Sequence[Pose]) -> Floats:
    """Return poses along straight joint moves through targets, start and targets included, shape (n, axes)."""
    stops = np.array([start, *way], dtype=np.float64)
    steps = np.diff(stops, axis=0)
    count = max(_FEWEST_SAMPLES, math.ceil(float(np.abs(steps).max()) / _SAMPLE_STEP))
    share = np.arange(1, count + 1) / count
    between = stops[:-1, None, :] + share[None, :, None] * steps[:, None, :]
    return np.vstack([stops[:1], between.reshape(-1, len(start))])


def speeds_of(system: System, start: Pose, way: Sequence[Pose]) -> Speeds:
    """Return the fastest that a way is driven."""
    arm = system.bench.arm
    travel = np.abs(np.diff(np.array([start, *way], dtype=np.float64), axis=0))
    rate = leg_rates(arm, travel)
    turning = [number for number, axis in enumerate(arm.axes) if axis.unit == "deg"]
    joint = float((travel[:, turning] * rate[:, None]).max(initial=0.0))
    chords = np.hypot.reduce(np.diff(system.tool_mm(sampled(start, way)), axis=0), axis=1).reshape(
        len(way), -1
    )
    return Speeds(joint, float((chords * chords.shape[1] * rate[:, None]).max()))
