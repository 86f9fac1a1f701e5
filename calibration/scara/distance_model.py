"""Distances that a model predicts, their residuals and derivatives (Eqs 5 and 10)."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from catseye.calibration.core.budget import Shared, White
from catseye.calibration.core.model import Parameters
from catseye.calibration.core.repeats import Repeats
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.arm import ArmDesign, arm_design
from catseye.calibration.scara.between_nodes import MeasuredPlaces
from catseye.calibration.scara.budget import Budget
from catseye.calibration.scara.budget_effects import (
    Geometry,
    combined_white_mm,
    measured_places,
    seen_along,
    shared_errors,
    white_errors,
)
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.points import Points


@dataclass(frozen=True)
class Beams:
    """Where beams run, and how their lengths answer to the arm.

    Attributes:
        length_mm: shape (n,).
        unit: unit vectors from the reflector to the arm, shape (n, 2).
        position_mm: where the arm stands, shape (n, 2).
        slopes: derivatives of the lengths by L1, L2, θ1 and θ2, shape (n, 4), mm/mm and mm/rad.
    """

    length_mm: Floats
    unit: Floats
    position_mm: Floats
    slopes: Floats


@dataclass(frozen=True)
class DistanceModel:
    """An arm seen through measured distances: a `catseye.calibration.core.model.Model`.

    Attributes:
        layout: order of the parameters.
        points: what was measured, n rows.
        design: the points' commands, prepared.
        budget: contributors to the uncertainty of a distance; None for what the points state alone.
        places: where the joints stand between their nodes in these and all further points of the measurement; None
            where these points are all.
    """

    layout: Layout
    points: Points
    design: ArmDesign
    budget: Budget | None = None
    places: MeasuredPlaces | None = None

    @cached_property
    def parameters(self) -> Parameters:
        """Names, units and gauge."""
        return self.layout.parameters()

    @property
    def weights(self) -> Floats:
        """Reciprocal white standard uncertainties, 1/mm, shape (n,); ones when none are stated."""
        return self.points.weights

    @property
    def stated(self) -> bool:
        """The points state their uncertainties."""
        return self.points.sigma_mm is not None

    @property
    def repeats(self) -> Repeats:
        """Distances that measure the same; maps distinguish directions of approach."""
        return Repeats.of_numbers(self.points.repeats(bidirectional=self.layout.model == "error-map"))

    def beams(self, parameters: Floats) -> Beams:
        """Return the beams at parameters of shape (p,), with what moves their ends."""
        moved = self.design.local_jacobian(parameters)
        # J1 moves the end of the arm at a right angle to where it stands.
        places = parameters[self.layout.reflectors].reshape(-1, 2)[self.points.reflector]
        position = np.stack([moved[:, 1, 2], -moved[:, 0, 2]], axis=1)
        beam = position - places
        length = np.hypot(beam[:, 0], beam[:, 1])
        unit = beam / length[:, None]
        return Beams(length, unit, position, np.einsum("ni,nij->nj", unit, moved))

    def geometry(self, parameters: Floats) -> Geometry:
        """Return how the distances answer to the arm at parameters of shape (p,)."""
        return self.geometry_of(self.beams(parameters))

    def geometry_of(self, beams: Beams) -> Geometry:
        """Return how the distances answer to the arm."""
        beam, turn = (beams.unit, beams.length_mm), beams.slopes[:, 2:]
        return seen_along(self.points, beams.position_mm, beam, turn, self.layout)

    def white(self, parameters: Floats) -> tuple[White, ...]:
        """Return the errors that differ from reading to reading."""
        sigma = self.points.sigma_mm
        if sigma is None:
            return (White("scatter of the fit", np.ones(len(self.points))),)
        if self.budget is None or not self.budget.white:
            return (White("sigma_mm of the points", sigma),)
        geometry = self.geometry(parameters)
        # The weights were made at the starting values; what they are is what the contributors share.
        return white_errors(self.budget, geometry, sigma / combined_white_mm(self.budget, geometry))

    def shared(self, parameters: Floats) -> tuple[Shared, ...]:
        """Return the errors that several distances have in common."""
        return shared_errors(self.budget, replace(self.geometry(parameters), places=self._places))

    @cached_property
    def _places(self) -> MeasuredPlaces:
        """Where the joints stand between their nodes."""
        return measured_places(self.layout, self.points.commands) if self.places is None else self.places

    def residuals(self, parameters: Floats) -> Floats:
        """Return predicted minus measured displacement, mm, shape (n,)."""
        return self.residuals_of(self.beam(parameters)[0], parameters)

    def residuals_of(self, length_mm: Floats, parameters: Floats) -> Floats:
        """Return the residuals of beams of these lengths, mm, shape (n,)."""
        dead_path = parameters[self.layout.dead_path][self.points.dead_path]
        return length_mm + self.design.added("length", parameters) - dead_path - self.points.displacement_mm

    def jacobian(self, parameters: Floats) -> Floats:
        """Return the derivatives of the residuals, shape (n, layout.size), mm/mm and mm/rad."""
        beams = self.beams(parameters)
        rows, unit = np.arange(len(self.points)), beams.unit
        jacobian = np.zeros((len(self.points), self.layout.size))
        jacobian[:, : self.layout.arm_size] = self.design.spread(beams.slopes)
        for i, term in enumerate(self.layout.terms):
            if term.target == "length":
                jacobian[:, self.layout.extension.start + i] = self.design.extra[:, i]
        place = self.layout.reflectors.start + 2 * self.points.reflector
        jacobian[rows, place] = -unit[:, 0]
        jacobian[rows, place + 1] = -unit[:, 1]
        jacobian[rows, self.layout.dead_path.start + self.points.dead_path] = -1.0
        return jacobian

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


def distance_model(
    layout: Layout, points: Points, budget: Budget | None = None, places: MeasuredPlaces | None = None
) -> DistanceModel:
    """Prepare points for a model.

    Args:
        budget: contributors to the uncertainty of a distance; None for what the points state alone.
        places: where the joints stand between their nodes in all rows; None where these points are all.

    Raises:
        MapRangeError: a point lies outside the nodes.
    """
    design = arm_design(layout, points.commands, points.theta4_rad, points.elapsed_share, points.mount_rad)
    return DistanceModel(layout, points, design, budget, places)
