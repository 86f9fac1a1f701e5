"""What the whole budget brings as weights, and whether it stays honest where the budget is wrong.

The error motions are simulated by loops and plain trigonometry (tests.unit.calibration.scara.test_radial_budget); the
program sees distances alone.
"""

import os
import statistics
import time
from collections.abc import Callable

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.radial import RadialBudget
from tests.unit.calibration.scara.paper import MDEG, paper_points, random_truth
from tests.unit.calibration.scara.samples import identified, radial_motions
from tests.unit.calibration.scara.test_radial_budget import radial_errors

SETS = int(os.environ.get("CATSEYE_SETS", "100"))
STATED = RadialBudget(0.005, 0.005, 0.010)
THREE_TIMES = RadialBudget(0.015, 0.015, 0.030)
WHITE_MM = 0.010
ROUNDS = 15


def measured(seed: int, motions: RadialBudget, only: int | None = None) -> tuple[Points, Floats]:
    """Return distances of an arm drawn at random, and its links and tables."""
    truth, rng = random_truth(seed), np.random.default_rng(1000 + seed)
    noise = rng.normal(0.0, WHITE_MM, 1056) + radial_errors(rng, truth, motions, 3, only=only)
    return paper_points(truth, noise_mm=noise, sigma_mm=WHITE_MM), truth.table_vector()


def rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def errors(found: Identification, truth: Floats) -> tuple[Floats, Floats]:
    """Return errors of links and maps, and the same over their standard uncertainties."""
    error = found.parameters[: truth.size] - truth
    return error, error / found.standard_uncertainty[: truth.size]


def test_the_whole_budget_weighs_better_than_white_errors_alone() -> None:
    whole, white, normalised = [], [], []
    for seed in range(SETS):
        points, truth = measured(seed, STATED)
        error, z = errors(identified(points, budget=radial_motions(STATED)), truth)
        whole.append(error)
        normalised.append(z)
        white.append(errors(identified(points), truth)[0])
    parts = {"L1": slice(0, 1), "L2": slice(1, 2), "map 1": slice(2, 24), "map 2": slice(24, 40)}
    for name, part in parts.items():
        unit, text = (1e-3, "µm") if name.startswith("L") else (MDEG, "mdeg")
        mine, before = (rms(np.array(one)[:, part]) / unit for one in (whole, white))
        print(f"\n{name}: {mine:.2f} {text}, white weights {before:.2f}, ratio {mine / before:.2f}", end="")  # noqa: T201  # the figure
    spread = rms(np.array(normalised))
    print(f"\nnormalised errors {spread:.3f} rms of {SETS} sets (0.95…1.05)")  # noqa: T201  # the figure
    ratios = [
        rms(np.array(whole)[:, parts[k]]) / rms(np.array(white)[:, parts[k]]) for k in ("map 1", "map 2")
    ]
    assert ratios[0] <= 0.5
    assert ratios[1] <= 0.8
    assert 0.95 <= spread <= 1.05


@pytest.mark.parametrize(
    ("name", "motions", "only"),
    [("three times the stated", THREE_TIMES, None), ("all in harmonic 2", STATED, 2)],
)
def test_a_wrong_spectrum_stays_covered(name: str, motions: RadialBudget, only: int | None) -> None:
    normalised = []
    for seed in range(SETS):
        points, truth = measured(seed, motions, only)
        normalised.append(errors(identified(points, budget=radial_motions(STATED)), truth)[1])
    z = np.array(normalised)
    covered = float(np.mean(np.abs(z) < 1.96))
    print(f"\n{name}: {100 * covered:.1f} % in 95 % intervals (limit 93), {rms(z):.2f} rms, {SETS} sets")  # noqa: T201  # the figure
    assert covered >= 0.93


def test_the_spectrum_costs_less_than_ten_solves() -> None:
    points, _ = measured(1, STATED)
    asked, kept = radial_motions(STATED), radial_motions(STATED, learnt=True)

    def timed_s(work: Callable[[], object]) -> float:
        start_s = time.perf_counter()
        work()
        return time.perf_counter() - start_s

    pairs = [
        (timed_s(lambda: identified(points, budget=asked)), timed_s(lambda: identified(points, budget=kept)))
        for _ in range(ROUNDS)
    ]
    ratio = statistics.median(first / second for first, second in pairs)
    mine, other = (1e3 * statistics.median(column) for column in zip(*pairs, strict=True))
    print(f"\nspectrum estimated: {mine:.1f} ms, kept: {other:.1f} ms, ratio {ratio:.1f} (limit 11)")  # noqa: T201  # the figure
    assert ratio <= 11.0
