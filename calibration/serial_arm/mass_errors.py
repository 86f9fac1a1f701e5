"""What masses that are not quite known do to an identification: compliances take most of it up."""

from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.gravity import Load
from catseye.calibration.kinematics.joint_ranges import ranges_of
from catseye.calibration.serial_arm.closed_form import Start
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.identification import Calibration, identify_arm
from catseye.calibration.serial_arm.parameters import Compliance

_POSES = 200
_DRAWS = 5
_SEED = 1


@dataclass(frozen=True)
class MassErrors:
    """Errors of an arm that was identified with wrong masses and no other errors.

    Attributes:
        share: by which each mass and each coordinate of its centre is wrong, up or down.
        draws: sets of masses that were tried.
        error_mm: 3-D errors at random poses, shape (draws, poses).
    """

    share: float
    draws: int
    error_mm: Floats


def mass_errors(found: Calibration, share: float = 0.1) -> MassErrors | None:
    """Identify the arm once more from places as other masses would give them, without noise.

    Returns:
        None where nothing depends on masses, or where other things than places were measured.

    Raises:
        CalibrationError: the identification of such places fails.
    """
    model = found.model
    elastic = any(isinstance(one.role, Compliance) for one in model.chosen)
    if (
        not elastic
        or not len(model.measurements.points.pose)
        or model.measured_rows != 3 * len(model.measurements.points.pose)
    ):
        return None
    rng = np.random.default_rng(_SEED)
    poses = rng.uniform(*ranges_of(model.arm.chain), (_POSES, len(model.arm.chain.joints)))
    return MassErrors(share, _DRAWS, np.array([_one(found, share, poses, rng) for _ in range(_DRAWS)]))


def _wrong(load: Load, share: float, rng: np.random.Generator) -> Load:
    mass, x, y, z = 1.0 + share * rng.choice([-1.0, 1.0], 4)
    centre = load.centre_mm
    return replace(load, mass_kg=load.mass_kg * mass, centre_mm=(x * centre[0], y * centre[1], z * centre[2]))


def _one(found: Calibration, share: float, poses: Floats, rng: np.random.Generator) -> Floats:
    """Return the errors for one set of masses, shape (poses,)."""
    arm, geometry, measured = found.model.arm, found.geometry, found.model.measurements
    real = replace(arm, loads=tuple(_wrong(load, share, rng) for load in arm.loads))
    flange = geometry.frames(Commands.of(real, measured.commands.joints, measured.commands.approach))[-1]
    points = measured.points
    places = geometry.places_mm(flange[points.pose], points.target)
    values = zip((one.name for one in found.model.chosen), found.estimate.values.tolist(), strict=True)
    start = Start(found.model.start, dict(values))
    again = identify_arm(arm, replace(measured, points=replace(points, place_mm=places)), found.name, start)
    target = int(points.target[0])
    there = geometry.frames(Commands.of(real, poses))[-1]
    wanted = geometry.places_mm(there, np.full(len(poses), target))
    missed = again.places_mm(Commands.of(arm, poses), target) - wanted
    return np.asarray(np.linalg.norm(missed, axis=1))
