"""What a step test of one joint gives in the mean of many repeats, without an instrument and its noise."""

import numpy as np

from catseye.simulators.config import SerialArm
from catseye.simulators.world.serial.drivetrain import Drivetrains
from catseye.simulators.world.serial.screws import ScrewArm
from catseye.simulators.world.serial.servo import Encoders, Servos
from catseye.simulators.world.serial.truth import JointTruth
from catseye.simulators.world.types import Floats

_RUN_IN_DEG = 5.0
_BEYOND_DEG = 0.5
_SLOW, _FAST = 1e-3, 0.1
"""Speeds of steps and of the run-in, as parts of the largest."""


class RepeatedSteps:
    """Copies of one joint that take the same commands and differ in what is random.

    Args:
        truth: of the joint's drivetrain.
        joint: its number, from 0.
        pose_deg: of the arm, shape (n,).
        count: of copies.
        seed: of what is random.
    """

    def __init__(
        self, arm: SerialArm, truth: JointTruth, joint: int, pose_deg: Floats, count: int, seed: int
    ) -> None:
        truths = [truth] * count
        self._drivetrains = Drivetrains(truths)
        self._encoders = Encoders([arm.joints[joint]] * count, truths, seed)
        self._servos = Servos(truths, self._encoders, seed)
        weight_nm = float(ScrewArm(arm.joints, arm.loads).holding_torques(pose_deg[None])[0, joint])
        lever = float(np.sin(np.deg2rad(pose_deg[joint] - truth.counterbalance_zero_deg)))
        self._load_nm = np.full(count, weight_nm + truth.counterbalance_nm * lever)
        self._full_deg_s = arm.joints[joint].speed
        self._drive = self._drivetrains.at_rest(np.full(count, pose_deg[joint]), self._load_nm)
        self._time_s = 0.0

    def mean_errors_percent(self, sizes_deg: Floats, direction: int, dwell_s: float) -> Floats:
        """Return the mean step error of decaying steps in one direction, after a run-in; same shape.

        Args:
            sizes_deg: above 0, in their order.
            direction: 1 or -1.
            dwell_s: rest after each step.
        """
        self._step(-direction * (_RUN_IN_DEG + _BEYOND_DEG), _FAST, dwell_s)
        self._step(direction * _RUN_IN_DEG, _FAST, dwell_s)
        turned = [self._step(direction * size, _SLOW, dwell_s).mean() for size in sizes_deg.tolist()]
        return np.asarray(100.0 * (direction * np.array(turned) / sizes_deg - 1.0))

    def _step(self, increment_deg: float, speed_fraction: float, dwell_s: float) -> Floats:
        """Add an increment to what the encoders show; return how far the links turn, shape (count,)."""
        start = self._drive
        target = self._encoders.measured_deg(start.motor_deg, self._time_s) + increment_deg
        speed = np.full(target.size, speed_fraction * self._full_deg_s)
        wavy = self._drivetrains.wavy(start.link_deg)
        stops = self._servos.stops_deg(target, start.motor_deg, speed, wavy)
        moved = self._drivetrains.driven(start, stops, self._load_nm)
        self._drive = self._drivetrains.rested(moved, np.full(target.size, dwell_s))
        self._time_s += dwell_s
        return self._drive.link_deg - start.link_deg
