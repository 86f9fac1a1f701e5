"""What changed over a measurement, as the distances show it: the zero drifted, the links grew."""

from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.model import whitening_at
from catseye.calibration.core.projection import addition, project
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor, effects
from catseye.calibration.scara.drift_process import courses
from catseye.calibration.scara.identification import Identification


@dataclass(frozen=True)
class FoundDrift:
    """A contributor that changes with time, as likely as the distances and the budget make it.

    Attributes:
        contributor: with the spectrum that the distances have shown.
        change: from the beginning to the end; mm, or a share for scale and links.
        u_change: its standard uncertainty.
        rms: over the measurement, about its mean.
        u_rms: its standard uncertainty.
        probability: of distances that show so much of it when there is none.
    """

    contributor: Contributor
    change: float
    u_change: float
    rms: float
    u_rms: float
    probability: float

    @property
    def significant(self) -> bool:
        """It was there: neither scatter nor another contributor explains it."""
        return self.probability < SIGNIFICANCE


def found_drifts(identified: Identification) -> tuple[FoundDrift, ...]:
    """Return what the contributors that change with time did, as far as distances were asked about them.

    A scan keeps a sample of its distances, from which nothing is concluded.
    """
    budget = identified.budget
    if budget is None or identified.fit.n_points != len(identified.points):
        return ()
    asked = (one for one in budget.systematic if one.correlation == "time" and one.spectrum and one.u > 0.0)
    return tuple(_found(identified, one) for one in asked)


def _found(identified: Identification, contributor: Contributor) -> FoundDrift:
    mean, covariance = _sources(identified, contributor)
    sizes = contributor.u * np.sqrt(contributor.shares)
    ends = courses(np.array([-0.5, 0.5]), contributor.orders) * sizes
    change = ends[1] - ends[0]
    rms = float(np.linalg.norm(sizes * mean))
    slope = sizes**2 * mean / rms if rms > 0.0 else np.zeros(mean.size)
    return FoundDrift(
        contributor,
        float(change @ mean),
        float(np.sqrt(change @ covariance @ change)),
        rms,
        float(np.sqrt(slope @ covariance @ slope)),
        _probability(identified, contributor),
    )


def _sources(identified: Identification, contributor: Contributor) -> tuple[Floats, Floats]:
    """Return the conditional mean of a contributor's sources, shape (m,), and their covariance."""
    model, values = identified.model, identified.parameters
    whitening = whitening_at(model, values)
    own = effects(contributor, model.geometry(values))
    forces = whitening.forces(own)
    slopes = forces.T @ model.jacobian(values)
    known = forces.T @ own - slopes @ identified.covariance @ slopes.T / identified.fit.unit_weight_variance
    covariance = identified.fit.unit_weight_variance * (np.eye(known.shape[0]) - known)
    # Residuals are predicted minus measured.
    return -forces.T @ identified.residuals_mm, covariance


def _probability(identified: Identification, contributor: Contributor) -> float:
    """Test the process against none, as functions of time that a model with the other contributors lacks."""
    model, values = identified.model, identified.parameters
    others = tuple(one for one in model.budget.contributors if one != contributor) if model.budget else ()
    without = replace(model, budget=Budget(others))
    functions = effects(replace(contributor, u=1.0, spectrum=()), model.geometry(values))
    found = addition(project(without, values, identified.residuals_mm).settled, functions)
    return 1.0 if found is None else found.probability
