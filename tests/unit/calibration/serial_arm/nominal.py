"""The nominal arm and measurements of the true one, as the calibration takes them."""

from functools import cache

import numpy as np

from catseye.app.cell.arm import shipped_arm
from catseye.app.cell.serial_arm import chain_of
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.gravity import Load
from catseye.calibration.serial_arm.arm import SerialArm, Target
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.measurements import MeasuredPoints, Measurements
from tests.unit.calibration.serial_arm.true_arm import MASSES, NESTS, TrueArm, random_poses

NOISE_MM = 0.0404
"""Of each coordinate: 0.070 mm rms of the 3-D norm."""


@cache
def irb120() -> SerialArm:
    targets = tuple(Target(f"nest{k + 1}", (x, y, z)) for k, (x, y, z) in enumerate(NESTS.tolist()))
    loads = tuple(Load(frame, mass, centre) for frame, mass, centre in MASSES)
    return SerialArm(chain_of(shipped_arm("irb120")), loads, targets)


def measured(
    poses_deg: Floats, seed: int | None = None, true: TrueArm | None = None, moved_mm: Floats | None = None
) -> Measurements:
    """Measure one nest a pose, in turn; without a seed there is no noise."""
    nest = np.arange(len(poses_deg)) % len(NESTS)
    places = (true or TrueArm()).nests(poses_deg, nest) + (0.0 if moved_mm is None else moved_mm)
    covariance = None
    if seed is not None:
        places = places + NOISE_MM * np.random.default_rng(seed).standard_normal(places.shape)
        covariance = np.tile(NOISE_MM**2 * np.eye(3), (len(nest), 1, 1))
    names = tuple(f"pose {k + 1}" for k in range(len(nest)))
    points = MeasuredPoints(np.arange(len(nest)), nest, places, covariance)
    return Measurements(Commands.of(irb120(), poses_deg), names, points)


@cache
def validation(count: int = 200) -> tuple[Floats, Floats]:
    """Return poses and where the true arm puts nest 1."""
    poses = random_poses(count, 99)
    return poses, TrueArm().nests(poses, np.zeros(count, dtype=np.int64))
