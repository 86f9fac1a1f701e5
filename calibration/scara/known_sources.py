"""What the distances say of the sources of an error that they share."""

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Contributor
from catseye.calibration.scara.identification import Identification


def contributors_asked(identified: Identification) -> tuple[Contributor, ...]:
    """Return the systematic contributors; none after a robust loss, which weights rows otherwise than the budget."""
    if identified.budget is None or identified.fit.robust is not None:
        return ()
    return identified.budget.systematic


def known_sources(identified: Identification, contributor: Contributor) -> tuple[Floats, Floats]:
    """Return the conditional mean of a contributor's sources, shape (m,), and their covariance, shape (m, m).

    Sources have unit variance as long as no distances have been asked; what they are beside identified parameters
    that take up some of them is as uncertain as those.
    """
    mean, covariance = identified.sources.known(place_of(identified, contributor))
    return mean, identified.fit.unit_weight_variance * covariance


def place_of(identified: Identification, contributor: Contributor) -> int:
    """Return the number of a contributor among the systematic ones of the budget."""
    systematic = () if identified.budget is None else identified.budget.systematic
    return systematic.index(contributor)
