"""Identified problems that the tests of this folder share."""

from dataclasses import replace

import numpy as np

from catseye.calibration.scara.budget import Axis, Budget, Contributor
from catseye.calibration.scara.extension import Term, crosstalk, j4_map, thermal_drift
from catseye.calibration.scara.identification import Identification, identify
from catseye.calibration.scara.layout import ModelName
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.radial import RadialBudget
from tests.unit.calibration.scara.paper import (
    NODES1_DEG,
    NODES2_DEG,
    NOMINAL_REFLECTORS,
    paper_points,
    random_truth,
)

SIGMA_MM = 0.0156
TERMS = (*crosstalk((2,)), *j4_map((2,)), *thermal_drift())

WEAK = crosstalk((1, 2))
"""Terms that the maps nearly absorb: the links are known to 63 µm beside them, and the second order counts."""


def noisy_points(seed: int = 8, sigma_mm: float | None = SIGMA_MM) -> Points:
    """Return the paper's measurement with white errors of 15.6 µm."""
    noise = np.random.default_rng(seed).normal(0.0, SIGMA_MM, 1056)
    return paper_points(random_truth(seed), noise_mm=noise, sigma_mm=sigma_mm)


def segmented(points: Points) -> Points:
    """Return the points with a break of the beam in the middle of each reflector's series."""
    second = np.tile(np.arange(352) >= 200, 3).astype(np.int64)
    paths = tuple((name, segment) for name in points.reflector_names for segment in (0, 1))
    return replace(points, dead_path=2 * points.reflector + second, dead_paths=paths)


def identified(
    points: Points | None = None,
    model: ModelName = "error-map",
    budget: Budget | None = None,
    terms: tuple[Term, ...] = (),
) -> Identification:
    """Return an identification of the paper's problem, or of one with fewer of its reflectors."""
    nodes = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)
    chosen = noisy_points() if points is None else points
    places = NOMINAL_REFLECTORS[: len(chosen.reflector_names)]
    return identify(chosen, model, *nodes, 325.0, 225.0, places, budget, terms)


def radial_motions(budget: RadialBudget, *, learnt: bool = False) -> Budget:
    """Return radial error motions of J1, J2 and J4 as contributors.

    Args:
        learnt: distances have shown that their harmonics are even, so that nobody asks again.
    """
    stated: tuple[tuple[Axis, float], ...] = (
        ("j1", budget.j1_mm),
        ("j2", budget.j2_mm),
        ("j4", budget.j4_mm),
    )
    return Budget(
        tuple(
            Contributor(
                axis.upper(),
                "radial",
                u,
                "axis-angle",
                axis,
                orders=budget.orders,
                spectrum=(1.0,) * budget.orders if learnt else (),
            )
            for axis, u in stated
        )
    )
