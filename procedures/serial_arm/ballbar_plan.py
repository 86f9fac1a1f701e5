"""The paths of a ballbar, as they are led."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.motion.motion_time import way_time_s
from catseye.procedures.serial_arm.bench import Ballbar, SerialBench


@dataclass(frozen=True)
class BarPath:
    """The path of one nest.

    Attributes:
        nest: its name.
        commands: of the calibrated arm, in order.
        measured: numbers of the commands at which the bar is read.
        deviation_mm: that is predicted at each command.
        largest_mm: the largest that is predicted, between the commands too.
    """

    nest: str
    commands: tuple[Pose, ...]
    measured: tuple[int, ...]
    deviation_mm: tuple[float, ...]
    largest_mm: float


@dataclass(frozen=True)
class BallbarPlan:
    """All paths.

    Attributes:
        bench: what it was made from.
        ballbar: its lengths.
        rest: from where the paths are reached.
        paths: in order.
        dwell_s: standstill before a reading.
        readings: typed, or from a file.
    """

    bench: SerialBench
    ballbar: Ballbar
    rest: Pose
    paths: tuple[BarPath, ...]
    dwell_s: float
    readings: Literal["typed", "file"]

    def path_s(self, path: BarPath) -> float:
        """Return the expected bench time of a path, s."""
        way = np.array([self.rest, *path.commands, self.rest])
        return way_time_s(self.bench.arm, way) + len(path.measured) * self.dwell_s
