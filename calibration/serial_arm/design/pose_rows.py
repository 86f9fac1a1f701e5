"""What poses would show of an arm before anything is measured there: the rows that pose selection works on."""

import numpy as np

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.identification import ModelName, parameters_of
from catseye.calibration.serial_arm.measurements import MeasuredPoints, Measurements
from catseye.calibration.serial_arm.model import ArmModel
from catseye.calibration.serial_arm.redundancy import choose_basis


def candidate_rows(arm: SerialArm, joints: Floats, target: Ints, name: ModelName) -> Floats:
    """Return the derivatives of the place of one target at each pose, redundant parameters left out.

    Args:
        arm: nominal.
        joints: deg or mm, shape (n, joints).
        target: number of the target that is measured at each pose, shape (n,).
        name: model whose parameters are to be identified.

    Returns:
        mm per unit of each parameter, shape (n, 3, parameters).
    """
    number = len(joints)
    points = MeasuredPoints(np.arange(number), target, np.zeros((number, 3)))
    names = tuple(str(k) for k in range(number))
    measurements = Measurements(Commands.of(arm, joints), names, points)
    model = ArmModel(arm, np.eye(4), parameters_of(arm, measurements, name), measurements)
    jacobian = model.jacobian(np.array([one.nominal for one in model.chosen]))[: 3 * number]
    kept = list(choose_basis(arm.chain, model.chosen, jacobian).kept)
    return jacobian[:, kept].reshape(number, 3, len(kept))
