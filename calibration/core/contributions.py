"""How much each contributor of the budget makes of each result."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.budget import DistanceErrors, distance_errors
from catseye.calibration.core.fit_statistics import point_weights
from catseye.calibration.core.least_squares import factorise
from catseye.calibration.core.propagation import effective_dof
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.arm import arm_design
from catseye.calibration.scara.distance_model import distance_model
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.points import Commands


@dataclass(frozen=True)
class Contributions:
    """The covariance of the estimates, taken apart.

    Attributes:
        errors: the contributors, and what the fit widens them by.
        covariances: of the estimates from each contributor alone, widening included, shape (contributors, p, p).
    """

    errors: DistanceErrors
    covariances: Floats

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the contributors."""
        return tuple(one.name for one in self.errors.contributors)

    @property
    def covariance(self) -> Floats:
        """Covariance of the estimates from all contributors, shape (p, p)."""
        return np.asarray(self.covariances.sum(axis=0))

    @property
    def variances(self) -> Floats:
        """Variance that each contributor gives each parameter, shape (contributors, p)."""
        return np.asarray(np.maximum(np.einsum("kii->ki", self.covariances), 0.0))

    def of_combinations(self, combinations: Floats) -> Floats:
        """Return the variance that each contributor gives to results.

        Args:
            combinations: derivatives of the results by the parameters, shape (m, p).

        Returns:
            Variances, shape (contributors, m).
        """
        variances = np.einsum("kmp,mp->km", combinations @ self.covariances, combinations)
        return np.asarray(np.maximum(variances, 0.0))

    def effective_dof(self, variances: Floats) -> Floats:
        """Return the effective degrees of freedom of results (Welch–Satterthwaite).

        Args:
            variances: what each contributor gives to each result, shape (contributors, m).

        Returns:
            Degrees of freedom, shape (m,).
        """
        # The widening multiplies everything, so it counts as one more input of full size.
        dof = np.array([*(one.dof for one in self.errors.contributors), self.errors.factor_dof])
        totals = variances.sum(axis=0)
        parts = np.sqrt(np.vstack([variances, totals]))
        return np.array(
            [effective_dof(part, dof, float(np.sqrt(v))) for part, v in zip(parts.T, totals, strict=True)]
        )


def contributions(identified: Identification) -> Contributions:
    """Take the covariance of an identification apart.

    Args:
        identified: what the solver returned.

    Returns:
        Contributions; their sum is the covariance of the law of propagation.
    """
    errors, gain = distance_errors(identified), _gain(identified)
    parts = []
    for white in errors.white:
        # A product with its own transpose is symmetric to the last digit.
        parts.append(_square(gain * white.sigma_mm))
    for shared in errors.shared:
        parts.append(_square(gain @ shared.effects_mm))
    return Contributions(errors, errors.factor * np.stack(parts))


def path_variances(identified: Identification, found: Contributions, commands: Commands) -> Floats:
    """Return the variances that each contributor gives to predicted positions.

    Args:
        identified: the arm.
        found: its contributions.
        commands: n commands within the identified range.

    Returns:
        Variances of x and y, mm², shape (contributors, n, 2).

    Raises:
        MapRangeError: a command lies outside the nodes.
    """
    design, size = arm_design(identified.layout.of_arm(), commands), identified.layout.arm_size
    local = design.local_jacobian(identified.parameters[:size])
    arm = Contributions(found.errors, found.covariances[:, :size, :size])
    return np.stack([arm.of_combinations(design.spread(local[:, axis])) for axis in range(2)], axis=2)


def _gain(identified: Identification) -> Floats:
    """Return what the estimates move by per distance, shape (p, n)."""
    model, weights = distance_model(identified.layout, identified.points), point_weights(identified.points)
    basis = identified.layout.gauge_basis()
    jacobian = model.jacobian(identified.parameters) * weights[:, None]
    white = basis @ factorise(jacobian @ basis).covariance() @ basis.T
    return np.asarray(white @ (jacobian * weights[:, None]).T)


def _square(columns: Floats) -> Floats:
    return np.asarray(columns @ columns.T)
