"""A fit of distances seen as a projection."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.projection import Projection, project
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget_effects import Geometry
from catseye.calibration.scara.extension import Source
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.planar import wrap_rad
from catseye.calibration.scara.pointing import beam_turn_rad
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
    return DistanceProjection(found.whitening, found.orthonormal, found.residuals, model.geometry(values))


def angles_rad(
    points: Points, nominal_mm: tuple[float, float], reflectors_mm: Floats
) -> Mapping[Source, Floats]:
    """Return the angles that errors may follow: of J1, J2 and J4, rad, shape (n,).

    J4 stands at the angle of the beam against link 2, less what the interferometer is turned on its flange.

    Args:
        nominal_mm: nominal links, mm.
        reflectors_mm: places that the beam was aimed at, mm, shape (reflectors, 2).
    """
    return {
        "theta1": points.commands.theta1_rad,
        "theta2": points.commands.theta2_rad,
        "theta4": wrap_rad(beam_turn_rad(points, nominal_mm, reflectors_mm) - mounts_rad(points)),
    }


def mounts_rad(points: Points) -> Floats:
    """Return by how much the interferometer is turned on J4's flange, rad, shape (n,)."""
    return np.zeros(len(points)) if points.mount_rad is None else points.mount_rad
