"""Distances that a model predicts, their residuals and derivatives (Eqs 5 and 10)."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.arm import ArmDesign, arm_design
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.points import Points


@dataclass(frozen=True)
class DistanceModel:
    """A model of the arm seen through measured distances.

    Attributes:
        layout: order of the parameters.
        points: what was measured, n rows.
        design: the points' commands, prepared.
    """

    layout: Layout
    points: Points
    design: ArmDesign

    def residuals(self, parameters: Floats) -> Floats:
        """Return predicted minus measured displacement, mm, shape (n,)."""
        length = self.beam(parameters)[0] + self.design.added("length", parameters)
        dead_path = parameters[self.layout.dead_path][self.points.dead_path]
        return length - dead_path - self.points.displacement_mm

    def jacobian(self, parameters: Floats) -> Floats:
        """Return the derivatives of the residuals, shape (n, layout.size), mm/mm and mm/rad."""
        _, unit = self.beam(parameters)
        rows = np.arange(len(self.points))
        jacobian = np.zeros((len(self.points), self.layout.size))
        local = np.einsum("ni,nij->nj", unit, self.design.local_jacobian(parameters))
        jacobian[:, : self.layout.arm_size] = self.design.spread(local)
        for i, term in enumerate(self.layout.terms):
            if term.target == "length":
                jacobian[:, self.layout.extension.start + i] = self.design.extra[:, i]
        place = self.layout.reflectors.start + 2 * self.points.reflector
        jacobian[rows, place] = -unit[:, 0]
        jacobian[rows, place + 1] = -unit[:, 1]
        jacobian[rows, self.layout.dead_path.start + self.points.dead_path] = -1.0
        return jacobian

    def beam_unit(self, parameters: Floats) -> Floats:
        """Return the unit vectors from reflector to arm, shape (n, 2)."""
        return self.beam(parameters)[1]

    def start(self, link1_mm: float, link2_mm: float, reflectors_mm: Floats) -> Floats:
        """Return starting values: nominal arm, rough reflectors, dead paths that fit them.

        Args:
            link1_mm: nominal length of link 1, mm.
            link2_mm: nominal length of link 2, mm.
            reflectors_mm: rough places, mm, shape (reflectors, 2).
        """
        parameters = np.zeros(self.layout.size)
        parameters[:2] = link1_mm, link2_mm
        parameters[self.layout.reflectors] = np.ravel(reflectors_mm)
        counts = np.bincount(self.points.dead_path, minlength=len(self.layout.dead_paths))
        sums = np.bincount(
            self.points.dead_path, self.residuals(parameters), minlength=len(self.layout.dead_paths)
        )
        parameters[self.layout.dead_path] = sums / counts
        return parameters

    def beam(self, parameters: Floats) -> tuple[Floats, Floats]:
        """Return the beam's lengths, mm, shape (n,), and unit vectors from reflector to arm, shape (n, 2)."""
        places = parameters[self.layout.reflectors].reshape(-1, 2)
        beam = self.design.positions(parameters) - places[self.points.reflector]
        length = np.hypot(beam[:, 0], beam[:, 1])
        return length, beam / length[:, None]


def distance_model(layout: Layout, points: Points) -> DistanceModel:
    """Prepare points for a model.

    Raises:
        MapRangeError: a point lies outside the nodes.
    """
    design = arm_design(layout, points.commands, points.theta4_rad, points.elapsed_share)
    return DistanceModel(layout, points, design)
