"""An arm identified so that single wrong distances hardly move it."""

from dataclasses import dataclass, replace

from catseye.calibration.core.arguments import require_one_of
from catseye.calibration.core.contributions import Contributions
from catseye.calibration.core.robust import Loss, robust_estimate
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.identification import Identification


@dataclass(frozen=True)
class RobustFit:
    """A robust identification.

    Attributes:
        identified: the estimate with its sandwich covariance.
        scale: robust standard deviation of a distance in units of its stated white uncertainty (mm when none).
        weights: what each distance counts, 0…1, shape (n,).
        contributions: its covariance, taken apart.
    """

    identified: Identification
    scale: float
    weights: Floats
    contributions: Contributions


def robust_fit(identified: Identification, loss: Loss) -> RobustFit:
    """Identify again with a robust loss; see `catseye.calibration.core.robust.robust_estimate`.

    Args:
        identified: estimate of least squares, from where the iteration starts.

    Raises:
        ConvergenceError: the weights do not settle.
        ArgumentError: the loss is unknown.
    """
    require_one_of(Loss, loss, "loss")
    found = robust_estimate(identified.model, identified.estimate, loss, "scatter of the distances")
    robust = replace(
        identified,
        parameters=found.estimate.values,
        covariance=found.estimate.covariance,
        residuals_mm=found.estimate.residuals_mm,
        fit=found.estimate.fit,
    )
    return RobustFit(robust, found.scale, found.weights, found.contributions)
