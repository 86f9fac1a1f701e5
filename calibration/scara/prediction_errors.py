"""What separates measured rows from predicted ones: one covariance for everybody who predicts, its parts named.

A prediction is as good as the identified parameters, what lies between the nodes, and what the arm does anew wherever
it goes: it does not repeat, and its axes move radially. The rows are coordinates of the J4 axis, or distances to it.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from catseye.calibration.core.budget import Shared, White
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.arm import arm_design
from catseye.calibration.scara.budget import IDENTIFIED, Budget
from catseye.calibration.scara.budget_effects import Geometry, shared_errors, white_errors
from catseye.calibration.scara.identification import IdentifiedArm, TakenUp
from catseye.calibration.scara.points import Commands, Points


@dataclass(frozen=True)
class PredictionErrors:
    """Errors of n rows.

    Attributes:
        white: those that differ from row to row.
        shared: those that several rows have in common, the identified parameters first.
    """

    white: tuple[White, ...]
    shared: tuple[Shared, ...]

    @cached_property
    def effects_mm(self) -> Floats:
        """What independent sources of unit variance do to the rows, shape (n, k)."""
        return np.hstack([one.effects_mm for one in self.shared])

    @cached_property
    def white_mm2(self) -> Floats:
        """Variances of what differs from row to row, shape (n,)."""
        squares = [np.zeros(len(self.effects_mm)), *(one.sigma_mm**2 for one in self.white)]
        return np.asarray(np.sum(squares, axis=0), dtype=np.float64)

    @property
    def variances_mm2(self) -> dict[str, Floats]:
        """What each contributor gives to the variances, shape (n,) each."""
        shared = {one.name: np.sum(one.effects_mm**2, axis=1) for one in self.shared}
        return shared | {one.name: one.sigma_mm**2 for one in self.white}


def prediction_errors(
    gradient: Floats,
    covariance: Floats,
    taken_up: TakenUp,
    budget: Budget | None,
    geometry: Geometry,
    arrivals: int = 1,
) -> PredictionErrors:
    """Return the errors of predicted rows.

    Args:
        gradient: derivatives of the rows by the identified parameters, shape (n, p).
        covariance: of the parameters, shape (p, p).
        taken_up: what contributors have moved the parameters by. Where they act again, they err by what they do less
            what the parameters have taken up of it.
        budget: contributors that act on the rows; None for the parameters alone.
        geometry: of the rows.
        arrivals: so many measurements of a row are averaged.
    """
    if budget is None:
        return PredictionErrors((), (_identified(gradient, covariance),))
    shared: list[Shared] = []
    for contributor, one in zip(budget.systematic, shared_errors(budget, geometry), strict=True):
        moved = taken_up.get(contributor)
        if moved is not None:
            covariance = covariance - moved @ moved.T
            one = replace(one, effects_mm=one.effects_mm - gradient @ moved)
        shared.append(one)
    share = np.full(len(gradient), 1.0 / math.sqrt(arrivals))
    return PredictionErrors(
        white_errors(budget, geometry, share), (_identified(gradient, covariance), *shared)
    )


def _identified(gradient: Floats, covariance: Floats) -> Shared:
    values, vectors = np.linalg.eigh(covariance)
    return Shared(IDENTIFIED, gradient @ (vectors * np.sqrt(np.maximum(values, 0.0))))


def position_errors(
    arm: IdentifiedArm, commands: Commands, arrivals: int = 1, *, alone: bool = False
) -> PredictionErrors:
    """Return the errors of x and y of each command in turn, 2n rows.

    The tool is taken not to turn against link 2 along the commands: what J4's axis does is one displacement in the
    frame of link 2.

    Args:
        commands: n rows inside the identified range.
        arrivals: so many measurements of each position are averaged.
        alone: what different commands have in common is not asked for, which takes far fewer sources.

    Raises:
        MapRangeError: a command lies outside the nodes.
    """
    design = arm_design(arm.layout, commands)
    local = design.local_jacobian(arm.parameters)
    gradient = np.stack([design.spread(local[:, axis, :]) for axis in range(2)], axis=1)
    budget = None if arm.budget is None else arm.budget.of_arm
    rows = 2 * len(commands)
    return prediction_errors(
        gradient.reshape(rows, -1),
        arm.covariance,
        _but_j4(arm.taken_up),
        budget,
        replace(_coordinates(arm, commands, local.reshape(rows, 4)), alone=alone),
        arrivals,
    )


def _but_j4(taken_up: TakenUp) -> TakenUp:
    """Return what was taken up of anything but J4, whose angle nobody knows where the arm goes later."""
    return {one: moved for one, moved in taken_up.items() if one.axis != "j4"}


def _coordinates(arm: IdentifiedArm, commands: Commands, slopes: Floats) -> Geometry:
    twice = commands.select(np.repeat(np.arange(len(commands)), 2))
    nothing = np.zeros(len(twice), dtype=np.int64)
    zeros = np.zeros(len(twice))
    points = Points(twice, nothing, nothing, zeros, None, ("",), (("", 0),))
    axes = np.tile(np.eye(2), (len(commands), 1))
    # A J4 map describes beams; it does not act on positions.
    layout = replace(arm.layout, terms=())
    growth = slopes[:, :2] @ arm.parameters[:2]
    return Geometry(points, axes, zeros, slopes[:, 2:], zeros, layout, growth, zeros, later=True)
