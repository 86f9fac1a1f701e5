"""Several results at once: covariance, correlations and joint coverage regions of draws (JCGM 102)."""

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from catseye.calibration.core.propagation import correlation
from catseye.calibration.core.types import Bools, Floats


@dataclass(frozen=True)
class JointRegions:
    """Regions that hold all results at once with a coverage probability.

    Attributes:
        mean: estimates, shape (m,).
        covariance: of the results, shape (m, m).
        elliptical: factor of the ellipsoid (y − mean)ᵀ covariance⁻¹ (y − mean) ≤ factor².
        rectangular: factor of the box |y − mean| ≤ factor · u.
    """

    mean: Floats
    covariance: Floats
    elliptical: float
    rectangular: float

    @property
    def u(self) -> Floats:
        """Standard uncertainties, shape (m,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlation(self) -> Floats:
        """Correlation matrix, shape (m, m)."""
        return correlation(self.covariance)

    def in_ellipsoid(self, results: Floats) -> Bools:
        """Return which results of shape (n, m) lie in the ellipsoid, shape (n,)."""
        return _distance(results - self.mean, self.covariance) <= self.elliptical

    def in_box(self, results: Floats) -> Bools:
        """Return which results of shape (n, m) lie in the box, shape (n,)."""
        return np.asarray(np.all(np.abs(results - self.mean) <= self.rectangular * self.u, axis=1))


def joint_regions(draws: Floats, coverage: float = 0.95) -> JointRegions:
    """Return the joint regions of draws.

    Args:
        draws: one row a draw, shape (draws, m); more draws than results, none of which is a function of the others.
        coverage: 0...1.
    """
    mean, covariance = draws.mean(axis=0), np.atleast_2d(np.cov(draws, rowvar=False))
    centred = draws - mean
    box = np.max(np.abs(centred) / np.sqrt(np.diag(covariance)), axis=1)
    return JointRegions(
        mean,
        covariance,
        float(np.quantile(_distance(centred, covariance), coverage)),
        float(np.quantile(box, coverage)),
    )


def _distance(centred: Floats, covariance: Floats) -> Floats:
    root = linalg.cholesky(covariance, lower=True)
    return np.asarray(np.linalg.norm(linalg.solve_triangular(root, centred.T, lower=True), axis=0))
