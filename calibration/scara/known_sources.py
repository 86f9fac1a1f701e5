"""What the distances say of the sources of an error that they share."""

import numpy as np

from catseye.calibration.core.model import whitening_at
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Contributor, effects
from catseye.calibration.scara.identification import Identification


def known_sources(identified: Identification, contributor: Contributor) -> tuple[Floats, Floats]:
    """Return the conditional mean of a contributor's sources, shape (m,), and their covariance, shape (m, m).

    Sources have unit variance as long as no distances have been asked; what they are beside identified parameters
    that take up some of them is as uncertain as those.
    """
    model, values = identified.model, identified.parameters
    whitening = whitening_at(model, values)
    own = effects(contributor, model.geometry(values))
    forces = whitening.forces(own)
    slopes = forces.T @ model.jacobian(values)
    factor = identified.fit.unit_weight_variance
    known = forces.T @ own - slopes @ identified.covariance @ slopes.T / factor
    # Residuals are predicted minus measured.
    return -forces.T @ identified.residuals_mm, factor * (np.eye(known.shape[0]) - known)
