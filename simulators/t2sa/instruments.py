"""What the emulated SpatialAnalyzer measures with: points with the laser tracker of the bench, groups with its CMM.

SpatialAnalyzer points by itself at a point that it knows the name of. Here it knows where the nest of that name is;
how it would know that of a nest on an arm is not the emulation's business.
"""

import math
from dataclasses import dataclass
from typing import get_args

import numpy as np

from catseye.simulators.survey import Place
from catseye.simulators.world.serial.bench import SerialBench
from catseye.simulators.world.serial.cmm import Artifact
from catseye.simulators.world.serial.frames import placed
from catseye.simulators.world.types import Floats

Pose = tuple[float, float, float, float, float, float]
"""x, y, z, mm, and rotations with R = Rz·Ry·Rx, deg."""


@dataclass
class Instruments:
    """The instruments.

    Attributes:
        bench: what they look at.
    """

    bench: SerialBench

    def has_point(self, name: str) -> bool:
        """Return whether there is a nest of a name."""
        return name in self.bench.room.nests

    def has_group(self, name: str) -> bool:
        """Return whether there is something of a name that has a pose."""
        return name in get_args(Artifact) or (self.has_point(name) and self.bench.room.nests[name].on_tool)

    def begin(self, name: str) -> None:
        """Point at a nest, before the time over which it is measured passes."""
        times_s = np.array([self.bench.time_s])
        tracker = self.bench.tracker
        near = placed(tracker.station.into_at(times_s), self.bench.room.places_mm([name], times_s)[0])[0]
        x, y, z = near.tolist()
        tracker.aim((x, y, z))

    def point(self, duration_s: float) -> Place | None:
        """Return the point that was measured in the last seconds; None without one."""
        seen = self.bench.tracker.measure(duration_s)
        return None if seen is None else seen.place_mm

    def pose(self, group: str, duration_s: float) -> Pose | None:
        """Return the pose of a group measured in the last seconds; None if too little of it is seen.

        A group that is called like a nest of the tool has its frame there, parallel to that of the flange.
        """
        seen = self.bench.cmm.pose("base" if group == "base" else "tool", duration_s)
        if seen is None:
            return None
        frame = np.array(seen.frame)
        if self.has_point(group):
            frame[:3, 3] = placed(frame, self.bench.room.nests[group].place_mm)
        return pose_of(frame)


def pose_of(frame: Floats) -> Pose:
    """Return place and rotations of a frame, shape (4, 4)."""
    turned = frame[:3, :3]
    ry = math.atan2(-turned[2, 0], math.hypot(turned[0, 0], turned[1, 0]))
    rx, rz = math.atan2(turned[2, 1], turned[2, 2]), math.atan2(turned[1, 0], turned[0, 0])
    x, y, z = frame[:3, 3].tolist()
    return x, y, z, math.degrees(rx), math.degrees(ry), math.degrees(rz)
