"""How far an identified arm may be from its drawing: beyond that a table or a description is wrong, not the arm."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.serial_arm.identification import Calibration
from catseye.calibration.serial_arm.parameters import Compliance, Harmonic, Link, MapNode, Parameter, Reversal

_BEYOND_U = 3.0
"""Standard uncertainties by which a value must lie beyond its bound."""


@dataclass(frozen=True)
class Bounds:
    """Largest errors of an arm that was described and measured correctly.

    Attributes:
        length_mm: of a link.
        angle_deg: of an axis or a zero.
        joint_deg: of a joint's periodic error, its map, or its backlash.
        compliance: of a joint, rad/(N·mm); none is negative.
    """

    length_mm: float = 10.0
    angle_deg: float = 3.0
    joint_deg: float = 0.5
    compliance: float = 1e-5


BOUNDS = Bounds()
"""Those of an arm of which nothing else is known."""


def beyond_bounds(found: Calibration, bounds: Bounds = BOUNDS) -> tuple[str, ...]:
    """Return a sentence for each parameter that lies beyond its bounds by more than three standard uncertainties."""
    u = np.sqrt(np.diag(found.estimate.covariance))
    texts = []
    for parameter, value, its_u in zip(
        found.model.chosen, found.estimate.values.tolist(), u.tolist(), strict=True
    ):
        low, high = _range(parameter, bounds)
        if value < low - _BEYOND_U * its_u or value > high + _BEYOND_U * its_u:
            texts.append(
                f"{parameter.name} would be {value:.4g} {parameter.unit} (u {its_u:.2g}), outside "
                f"{low:.4g}…{high:.4g} {parameter.unit}"
            )
    return tuple(texts)


def _range(parameter: Parameter, bounds: Bounds) -> tuple[float, float]:
    match parameter.role:
        case Link():
            half = bounds.length_mm if parameter.unit == "mm" else bounds.angle_deg
            return parameter.nominal - half, parameter.nominal + half
        case Compliance():
            return 0.0, bounds.compliance
        case Harmonic() | MapNode() | Reversal():
            return -bounds.joint_deg, bounds.joint_deg
        case _:
            return -np.inf, np.inf
