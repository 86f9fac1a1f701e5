"""What poses would show of an arm before anything is measured there: the rows that pose selection works on."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.identification import ModelName, parameters_of, tell_apart
from catseye.calibration.serial_arm.measurements import MeasuredOrientations, MeasuredPoints, Measurements
from catseye.calibration.serial_arm.model import ArmModel

U_MM = 0.04
"""Standard uncertainty of a measured coordinate against which what is known beforehand is weighed: a tracker's."""


@dataclass(frozen=True)
class PoseRows:
    """What each pose says of the parameters of a model.

    Attributes:
        rows: derivatives of everything that is measured at a pose, mm per unit, shape (poses, rows, parameters); zero
            where fewer targets are measured than elsewhere.
        names: of the parameters that such measurements tell apart.
        known: information that is there beforehand of each, from its known spread, in units of a row's, shape
            (parameters,).
    """

    rows: Floats
    names: tuple[str, ...]
    known: Floats


def pose_rows(
    arm: SerialArm, joints: Floats, targets: Ints, name: ModelName, *, frames: bool = False
) -> PoseRows:
    """Return what each pose says of a model.

    Args:
        arm: nominal.
        joints: deg or mm, shape (n, joints).
        targets: numbers of the targets that are measured at each pose, −1 for none, shape (n, most).
        name: model whose parameters are to be identified.
        frames: targets are frames whose orientation is measured too, as an optical CMM does.
    """
    pose, place = np.nonzero(targets >= 0)
    target = targets[pose, place]
    measurements = Measurements(
        Commands.of(arm, joints),
        tuple(map(str, range(len(joints)))),
        MeasuredPoints(pose, target, np.zeros((len(pose), 3))),
        _turned(pose, target) if frames else MeasuredOrientations(),
    )
    model = ArmModel(arm, np.eye(4), parameters_of(arm, measurements, name), measurements)
    kept = tell_apart(model).kept
    jacobian = model.jacobian(np.array([one.nominal for one in model.chosen]))[:, kept]
    blocks = 2 if frames else 1
    # All places come first, then all orientations.
    measured = jacobian[: 3 * blocks * len(pose)].reshape(blocks, len(pose), 3, len(kept))
    rows = np.zeros((*targets.shape, blocks, 3, len(kept)))
    rows[pose, place] = measured.swapaxes(0, 1)
    chosen = [model.chosen[k] for k in kept]
    known = np.array([0.0 if one.u is None else (U_MM / one.u) ** 2 for one in chosen])
    return PoseRows(rows.reshape(len(joints), -1, len(kept)), tuple(one.name for one in chosen), known)


def _turned(pose: Ints, target: Ints) -> MeasuredOrientations:
    return MeasuredOrientations(pose, target, np.broadcast_to(np.eye(3), (len(pose), 3, 3)))
