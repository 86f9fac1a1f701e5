"""Measurements during which something changes, written down here: loops and plain trigonometry.

The zero drifts as a first-order autoregressive process, links grow while they are measured, a reflector moves between
two segments. The arm and its radial error motions are those of the other tests.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.radial import RadialBudget
from tests.unit.calibration.scara.paper import Truth, paper_points, random_truth, sequence, true_position
from tests.unit.calibration.scara.samples import radial_motions
from tests.unit.calibration.scara.test_radial_budget import radial_errors

MOTIONS = RadialBudget(0.005, 0.005, 0.010)
DRIFT = Contributor("drift of the zero", "length", 0.002, "time", orders=31)
WARMTH = Contributor("warmth of the links", "links", 2e-6, "time", orders=3)
STILL = radial_motions(MOTIONS)
CHANGING = Budget((*STILL.contributors, DRIFT, WARMTH))
ROWS = 1056


def course(order: int, share: float) -> float:
    """Return an order of a drift of rms 1, once a share of the measurement has passed: a line, then cosines."""
    if order == 1:
        return math.sqrt(12.0) * (0.5 - share)
    return math.sqrt(2.0) * math.cos(order * math.pi * share)


def autoregressive(rng: np.random.Generator, rms_mm: float, rows: float, count: int = ROWS) -> Floats:
    """Draw a stationary process whose correlation falls to 1/e over so many rows."""
    kept = math.exp(-1.0 / rows)
    values = [float(rng.normal(0.0, rms_mm))]
    for _ in range(count - 1):
        values.append(kept * values[-1] + float(rng.normal(0.0, rms_mm * math.sqrt(1.0 - kept**2))))
    return np.array(values)


def measured(seed: int, white_mm: float, drift_mm: Floats | float = 0.0) -> tuple[Points, Floats]:
    """Return distances with radial error motions, scatter and a drift, and the true links and tables."""
    truth, rng = random_truth(seed), np.random.default_rng(1000 + seed)
    noise = rng.normal(0.0, white_mm, ROWS) + radial_errors(rng, truth, MOTIONS, 3) + drift_mm
    return paper_points(truth, noise_mm=noise, sigma_mm=white_mm), truth.table_vector()


def lengths(seed: int, truth_at: Callable[[int], Truth]) -> Floats:
    """Return beam lengths of the paper's measurement, of an arm and places that change from row to row."""
    rows = [(j, row) for j in range(len(random_truth(seed).reflectors)) for row in sequence()]
    found = []
    for i, (j, row) in enumerate(rows):
        truth = truth_at(i)
        found.append(math.dist(true_position(truth, row), truth.reflectors[j]))
    return np.array(found)


def warmed(seed: int, ppm: float, white_mm: float) -> tuple[Points, Floats]:
    """Return distances of an arm whose links grow steadily about those of the truth."""
    truth = random_truth(seed)

    def at(i: int) -> Truth:
        share = 1.0 + 1e-6 * ppm * (i / (ROWS - 1) - 0.5)
        return replace(truth, link1_mm=truth.link1_mm * share, link2_mm=truth.link2_mm * share)

    return measured(seed, white_mm, lengths(seed, at) - lengths(seed, lambda _: truth))


def moved(seed: int, step_mm: float, white_mm: float) -> tuple[Points, Floats]:
    """Return distances in two segments a reflector; each reflector stands elsewhere in its second one."""
    truth, rng = random_truth(seed), np.random.default_rng(2000 + seed)
    other = replace(truth, reflectors=truth.reflectors + rng.normal(0.0, step_mm, (3, 2)))
    late = np.tile(np.arange(352) >= 176, 3)
    drift = lengths(seed, lambda i: other if late[i] else truth) - lengths(seed, lambda _: truth)
    points, values = measured(seed, white_mm, drift)
    paths = tuple((name, segment) for name in points.reflector_names for segment in (0, 1))
    return replace(points, dead_path=2 * points.reflector + late, dead_paths=paths), values
