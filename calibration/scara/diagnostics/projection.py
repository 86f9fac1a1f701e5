"""A fit of distances seen as a projection."""

from dataclasses import dataclass

from catseye.calibration.core.projection import Projection, project
from catseye.calibration.scara.budget import Geometry
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.points import Points


@dataclass(frozen=True)
class DistanceProjection(Projection):
    """A fit of distances on the space that its model cannot reach.

    Attributes:
        geometry: how the distances answer to the arm.
    """

    geometry: Geometry

    @property
    def points(self) -> Points:
        """That the identification was made from, in their order."""
        return self.geometry.points


def projection_of(identified: Identification) -> DistanceProjection:
    """Return an identification as a projection."""
    model, values = identified.model, identified.parameters
    found = project(model, values, identified.residuals_mm)
    return DistanceProjection(
        found.weights, found.orthonormal, found.residuals, found.effects, model.geometry(values)
    )
