"""Monte Carlo propagation of the distances' uncertainty: every draw is solved anew (JCGM 101)."""

from dataclasses import replace

import numpy as np

from calibration.distance_model import distance_model
from calibration.identification import Identification
from calibration.least_squares import minimise
from calibration.types import Floats
from calibration.uncertainty.budget import geometry_of, systematic_effects


def with_monte_carlo(identified: Identification, draws: int, seed: int) -> Identification:
    """Return an identification whose covariance comes from repeated draws.

    White errors of the stated standard uncertainty, and radial error motions where they are stated, are added to the
    distances that the identified arm predicts; the fit's variance factor widens them as it widens the Jacobian
    covariance.

    Args:
        identified: what the solver returned.
        draws: how many draws, at least 2.
        seed: of the draws.
    """
    points, fit = identified.points, identified.fit
    widened = np.sqrt(fit.variance_factor)
    sigma_mm = (1.0 if points.sigma_mm is None else points.sigma_mm) * widened
    effects = widened * _effects(identified)
    ideal = points.displacement_mm + identified.residuals_mm
    basis = identified.layout.gauge_basis()
    weights = np.ones(len(points)) if points.sigma_mm is None else 1.0 / points.sigma_mm
    rng = np.random.default_rng(seed)
    found = np.empty((draws, identified.layout.size))
    for k in range(draws):
        white = sigma_mm * rng.standard_normal(len(points))
        noisy = replace(
            points, displacement_mm=ideal + white + effects @ rng.standard_normal(effects.shape[1])
        )
        model = distance_model(identified.layout, noisy)
        found[k] = minimise(model.residuals, model.jacobian, identified.parameters, basis, weights).parameters
    return replace(identified, covariance=np.cov(found, rowvar=False))


def _effects(identified: Identification) -> Floats:
    model = distance_model(identified.layout, identified.points)
    return systematic_effects(identified.budget, geometry_of(model, identified.parameters))
