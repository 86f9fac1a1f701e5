"""A model with everything that it takes from the measurements: size of maps, wrong poses, drift, scatter of poses.

The final result and every calibration that poses are left out of are made here, in the same way.
"""

from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.errors import RejectionError, UnidentifiableError
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.base_drift import Drift, drift_errors, find_drift
from catseye.calibration.serial_arm.held_out import RejectedPose, most_contradicting
from catseye.calibration.serial_arm.identification import (
    Calibration,
    ModelName,
    estimated_again,
    identify_arm,
    refined,
)
from catseye.calibration.serial_arm.map_size import identify_maps
from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.model import ArmModel
from catseye.calibration.serial_arm.pose_scatter import find_scatter, scatter_errors

MOST_REJECTED = 0.2
"""Share of wrong poses beyond which the model is in doubt, not the measurement."""


@dataclass(frozen=True)
class Fitted:
    """An identified model with the errors that its rows share.

    Attributes:
        drift: of the base; None where none is seen.
        scatter_mm: by which each pose is off as a whole, a coordinate; None where it is not seen.
    """

    calibration: Calibration
    drift: Drift | None
    scatter_mm: float | None

    def model_of(self, measurements: Measurements) -> ArmModel:
        """Return the model of other rows, which have the same errors in common; nothing is estimated."""
        bare = replace(self.calibration.model, measurements=measurements, common=())
        values, common = self.calibration.estimate.values, []
        if self.drift is not None:
            common.append(drift_errors(bare, values, self.drift))
        if self.scatter_mm is not None:
            common.append(scatter_errors(bare, self.scatter_mm))
        return replace(bare, common=tuple(common))


def identified(arm: SerialArm, measurements: Measurements, name: ModelName) -> Calibration:
    """Identify a model, with maps of the likeliest size.

    Raises:
        CalibrationError: as of `identify_arm`.
    """
    return identify_maps(arm, measurements) if name == "maps" else identify_arm(arm, measurements, name)


def with_shared(found: Calibration) -> Fitted:
    """Return an identification that knows what its rows share."""
    drift = find_drift(found)
    if drift is not None:
        found = refined(found, (drift_errors(found.model, found.estimate.values, drift),))
    scatter_mm = find_scatter(found)
    if scatter_mm is not None:
        found = refined(found, (*found.model.common, scatter_errors(found.model, scatter_mm)))
    return Fitted(found, drift, scatter_mm)


def without_wrong_poses(
    arm: SerialArm, measurements: Measurements, name: ModelName, most: float = MOST_REJECTED
) -> tuple[Calibration, tuple[RejectedPose, ...]]:
    """Identify, and leave out poses that contradict all others: the worst one, again and again.

    Args:
        most: share of the poses that may go.

    Raises:
        RejectionError: more would have to go.
        CalibrationError: as of `identify_arm`.
    """
    kept = np.ones(len(measurements.commands), dtype=np.bool_)
    seen = np.unique(measurements.poses).size
    rejected: list[RejectedPose] = []
    while True:
        found, before = identified(arm, measurements.at(kept), name), len(rejected)
        while (worst := most_contradicting(found)) is not None:
            rejected.append(worst)
            kept[worst.pose] = False
            if len(rejected) > most * seen:
                raise RejectionError(
                    f"more than {100.0 * most:.0f} % of the poses contradict the model {name}: do not leave them "
                    "out, look for what moved (base, tracker, tool), for joints in another order, or take a richer "
                    "model"
                )
            try:
                found = estimated_again(found, replace(found.model, measurements=measurements.at(kept)))
            except UnidentifiableError:
                # The pose had the only rows of a target, say: what is left has other parameters.
                break
        if len(rejected) == before:
            return found, tuple(rejected)
