"""Many trials of one joint at once, as the resolution paper tests it, without an instrument and its noise."""

import numpy as np

from catseye.simulators.config import SerialArm
from catseye.simulators.world.serial.drivetrain import Drivetrains
from catseye.simulators.world.serial.screws import ScrewArm
from catseye.simulators.world.serial.servo import Encoders, Servos
from catseye.simulators.world.serial.truth import JointTruth
from catseye.simulators.world.types import Floats

STEPS_DEG: Floats = 0.1 * 1.072267 ** -np.arange(109.0)
"""Decaying steps of the proposed test (section 3.4)."""

POSITIONS_DEG = {
    "A1": (-175.0, -90.0, 0.0, 90.0, 175.0),
    "A2": (-130.0, -100.0, -70.0, -40.0, -15.0),
    "A3": (-110.0, -25.0, 60.0, 90.0, 145.0),
    "A4": (-180.0, -90.0, 0.0, 90.0, 180.0),
    "A5": (-110.0, -55.0, 0.0, 55.0, 110.0),
    "A6": (-180.0, -90.0, 0.0, 90.0, 180.0),
}
"""K1…K5 of each joint (Table 2)."""

_SLOW = 1e-3


def tested_pose(joint: int, position_deg: float) -> Floats:
    """Return the arm with a joint at its test position; A5 stands at 90° while A4 is tested (section 3.2)."""
    pose = np.array([0.0, -90.0, 90.0, 0.0, 90.0 if joint == 3 else 0.0, 0.0])
    pose[joint] = position_deg
    return pose


class Trials:
    """Copies of one joint that take the same commands.

    Args:
        joint: its number, from 0.
        position_deg: where it is tested.
        count: of copies.
        seed: of what scatters.
        dwell_s: rest after each move.
    """

    def __init__(
        self,
        arm: SerialArm,
        truth: JointTruth,
        joint: int,
        position_deg: float,
        count: int = 1,
        seed: int = 1,
        dwell_s: float = 5.0,
    ) -> None:
        truths, joints = [truth] * count, [arm.joints[joint]] * count
        self._drivetrains = Drivetrains(truths)
        self._encoders = Encoders(joints, truths, seed)
        self._servos = Servos(truths, self._encoders, seed)
        pose = tested_pose(joint, position_deg)
        load_nm = float(ScrewArm(arm.joints, arm.loads).holding_torques(pose[None])[0, joint])
        lever = np.sin(np.deg2rad(position_deg - truth.counterbalance_zero_deg))
        self._load_nm = np.full(count, load_nm + truth.counterbalance_nm * float(lever))
        self._full_deg_s = arm.joints[joint].speed
        self._motor_friction_nm = truth.motor_friction_nm
        self.drive = self._drivetrains.at_rest(np.full(count, position_deg), self._load_nm)
        self._stopped, self._dwell_s = self.drive, dwell_s
        self.torque_nm = self._load_nm
        self._time_s = 0.0

    def go(self, target_deg: Floats, speed_fraction: float = _SLOW) -> Floats:
        """Move, wait and return where the links stand."""
        start = self.drive
        speed = np.full(target_deg.size, speed_fraction * self._full_deg_s)
        wavy = self._drivetrains.wavy(start.link_deg)
        stops = self._servos.stops_deg(target_deg, start.motor_deg, speed, wavy)
        self._stopped = self._drivetrains.driven(start, stops, self._load_nm)
        self.drive = self._drivetrains.rested(self._stopped, np.full(target_deg.size, self._dwell_s))
        sense = np.sign(stops - start.motor_deg)
        self.torque_nm = self.drive.hold_nm + self.drive.friction_nm + sense * self._motor_friction_nm
        self._time_s += self._dwell_s
        return self.drive.link_deg

    def at_rest_deg(self, rest_s: Floats) -> Floats:
        """Return where the links stand so long after they have come to rest, shape (times, count)."""
        return self._drivetrains.rested(self._stopped, rest_s[:, None]).link_deg

    def rest(self, rest_s: float) -> None:
        """Rest as long as that since the joints stopped, in place of the dwell."""
        self.drive = self._drivetrains.rested(self._stopped, np.full(self._load_nm.size, rest_s))

    def step(self, increment_deg: float, speed_fraction: float = _SLOW) -> Floats:
        """Add an increment to what the encoder shows, as the proposed test does; return how far the links turn."""
        before = self.drive.link_deg
        shown = self._encoders.measured_deg(self.drive.motor_deg, self._time_s)
        return self.go(shown + increment_deg, speed_fraction) - before

    def run_in(self, direction: int) -> None:
        """Take up the play by 5° in the direction of the test."""
        self.step(-5.5 * direction, 0.1)
        self.step(5.0 * direction, 0.1)

    def decaying(self, direction: int, sizes_deg: Floats = STEPS_DEG) -> Floats:
        """Return the errors of decreasing steps after a run-in, in per cent, shape (steps, count)."""
        self.run_in(direction)
        errors = [self.step(direction * size) * direction / size - 1.0 for size in sizes_deg]
        return 100.0 * np.array(errors)

    def there_and_back(self, step_deg: float, cycles: int = 5) -> tuple[Floats, Floats]:
        """Step ten times forth and back by absolute commands, from half of that behind.

        Returns:
            Places of the first trial and its torques, shape (cycles, 2, 10) each.
        """
        start = self.drive.link_deg - 5.0 * step_deg
        self.go(start)
        places, torques = np.empty((cycles, 2, 10)), np.empty((cycles, 2, 10))
        ways = [np.arange(1, 11), np.arange(9, -1, -1)]
        for cycle in range(cycles):
            for back, numbers in enumerate(ways):
                for k, number in enumerate(numbers):
                    places[cycle, back, k] = self.go(start + number * step_deg)[0]
                    torques[cycle, back, k] = self.torque_nm[0]
        return places, torques


def least_step_deg(
    errors_percent: Floats, threshold_percent: float = 10.0, sizes_deg: Floats = STEPS_DEG
) -> float:
    """Return the least step by the paper's rule: the 11-point moving mean stays within the threshold down to it."""
    means = [np.mean(errors_percent[max(0, k - 5) : k + 6]) for k in range(sizes_deg.size)]
    outside = np.flatnonzero(np.abs(means) > threshold_percent)
    return float(sizes_deg[outside[0] - 1] if outside.size else sizes_deg[-1])
