"""A model with everything that it takes from the measurements: size of maps, wrong poses, drift, scatter of poses.

The final result and every calibration that poses are left out of are made here, in the same way.
"""

from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.budget import Shared
from catseye.calibration.core.errors import RejectionError, UnidentifiableError
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.base_drift import Drift, drift_errors, farthest_mm, find_drift
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
        scatter: by which each pose is off as a whole, a coordinate, in the measure of the stated uncertainties; None
            where it is not seen.
    """

    calibration: Calibration
    drift: Drift | None
    scatter: float | None

    @property
    def scatter_mm(self) -> float | None:
        """Standard deviation of each coordinate by which poses are off as a whole."""
        return None if self.scatter is None else self.scatter * self.calibration.scale

    @property
    def drift_mm(self) -> float | None:
        """How far the base went from where it stood at the first pose, root mean square of its coordinates."""
        return None if self.drift is None else farthest_mm(self.calibration, self.drift)

    def model_of(self, measurements: Measurements) -> ArmModel:
        """Return the model of other rows, which have the same errors in common; nothing is estimated."""
        bare = replace(self.calibration.model, measurements=measurements, common=())
        return replace(bare, common=_shared(bare, self.calibration.estimate.values, self.drift, self.scatter))


def identified(arm: SerialArm, measurements: Measurements, name: ModelName) -> Calibration:
    """Identify a model, with maps of the likeliest size.

    Raises:
        CalibrationError: as of `identify_arm`.
    """
    return identify_maps(arm, measurements) if name == "maps" else identify_arm(arm, measurements, name)


def with_shared(found: Calibration) -> Fitted:
    """Return an identification that knows what its rows share.

    Each size is relative to all other errors: once a scatter is seen, the drift is judged anew beside it.
    """
    drift = find_drift(found)
    scatter = find_scatter(_knowing(found, drift, None))
    if drift is not None and scatter is not None:
        drift = find_drift(_knowing(found, None, scatter))
    return Fitted(_knowing(found, drift, scatter), drift, scatter)


def _knowing(found: Calibration, drift: Drift | None, scatter: float | None) -> Calibration:
    """Return a calibration that knows of such errors."""
    common = _shared(found.model, found.estimate.values, drift, scatter)
    return refined(found, common) if common else found


def _shared(
    model: ArmModel, values: Floats, drift: Drift | None, scatter: float | None
) -> tuple[Shared, ...]:
    found = [] if drift is None else [drift_errors(model, values, drift)]
    return tuple(found if scatter is None else [*found, scatter_errors(model, scatter)])


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
