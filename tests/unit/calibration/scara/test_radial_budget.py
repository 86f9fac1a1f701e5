"""Radial error motions: their covariance, and what they do to an identification.

The error motions are simulated here as sums of harmonics of the joint angles, by loops and plain trigonometry.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from catseye.calibration.core.errors import BudgetError
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.radial import RadialBudget, radial_effects
from tests.unit.calibration.scara.diagnostics.bench import commands_on_nodes, measured, problem
from tests.unit.calibration.scara.paper import (
    NODES1_DEG,
    NODES2_DEG,
    Truth,
    paper_points,
    random_truth,
    sequence,
    true_position,
)
from tests.unit.calibration.scara.samples import identified, radial_motions

ORDERS = 5
BUDGET = RadialBudget(0.005, 0.005, 0.010, ORDERS)
WHITE_MM = 0.010
SEEDS = 40


def harmonics(
    rng: np.random.Generator, rms_mm: float, orders: int, only: int | None = None
) -> list[tuple[float, float]]:
    """Draw cosine and sine amplitudes that give the stated rms displacement, all of it in one order if asked."""
    if only is not None:
        sizes = [rms_mm if order == only else 0.0 for order in range(1, orders + 1)]
    else:
        sizes = [rms_mm / math.sqrt(orders)] * orders
    return [(float(rng.normal(0.0, size)), float(rng.normal(0.0, size))) for size in sizes]


def wave(terms: list[tuple[float, float]], angle: float) -> float:
    total = 0.0
    for k, (c, s) in enumerate(terms, 1):
        total += c * math.cos(k * angle) + s * math.sin(k * angle)
    return total


def radial_errors(
    rng: np.random.Generator,
    truth: Truth,
    budget: RadialBudget,
    reflectors: int,
    every: int = 1,
    only: int | None = None,
) -> Floats:
    """Return what displaced axes add to each distance (to each nth): J1 in the world, J2 on link 1, J4 on link 2."""
    one_terms, two_terms, beam_terms = (
        [harmonics(rng, rms, budget.orders, only) for _ in "xy"]
        for rms in (budget.j1_mm, budget.j2_mm, budget.j4_mm)
    )
    # The commands stand on nodes: J1 and J2 displace in few ways.
    of_one = [[wave(terms, math.radians(node)) for terms in one_terms] for node in NODES1_DEG]
    of_two = [[wave(terms, math.radians(node)) for terms in two_terms] for node in NODES2_DEG]
    errors = []
    for j in range(reflectors):
        for row in sequence()[::every]:
            one, two = math.radians(NODES1_DEG[row[0]]), math.radians(NODES2_DEG[row[1]])
            x, y = true_position(truth, row)
            px, py = truth.reflectors[j]
            length = math.hypot(x - px, y - py)
            towards_arm = ((x - px) / length, (y - py) / length)
            turn_of_j4 = math.atan2(py - y, px - x) - one - two
            of_beam = [wave(terms, turn_of_j4) for terms in beam_terms]
            moved_x = moved_y = 0.0
            for (dx, dy), frame in zip(
                (of_one[row[0]], of_two[row[1]], of_beam), (0.0, one, one + two), strict=True
            ):
                moved_x += dx * math.cos(frame) - dy * math.sin(frame)
                moved_y += dx * math.sin(frame) + dy * math.cos(frame)
            errors.append(moved_x * towards_arm[0] + moved_y * towards_arm[1])
    return np.array(errors)


def units(truth: Truth, reflectors: int) -> Floats:
    beams = [
        np.subtract(true_position(truth, row), truth.reflectors[j])
        for j in range(reflectors)
        for row in sequence()
    ]
    return np.array([beam / math.hypot(*beam) for beam in beams])


def solve(points: Points, radial: RadialBudget | None) -> Identification:
    return identified(points, budget=None if radial is None else radial_motions(radial))


def true_parameters(truth: Truth) -> Floats:
    return np.concatenate([truth.table_vector(), truth.reflectors.ravel()])


@pytest.mark.parametrize(
    "budget",
    [
        BUDGET,
        RadialBudget(0.02, 0.0, 0.0, 2),
        RadialBudget(0.0, 0.02, 0.0, 3),
        RadialBudget(0.0, 0.0, 0.02, 1),
    ],
)
def test_covariance_of_the_distances_agrees_with_simulated_error_motions(budget: RadialBudget) -> None:
    truth = random_truth(1)
    effects = radial_effects(paper_points(truth, reflectors=1), units(truth, 1), budget)
    assert effects.shape == (352, 12 * budget.orders)
    rng = np.random.default_rng(20)
    drawn = np.array([radial_errors(rng, truth, budget, 1, every=9) for _ in range(600)])
    stated = (effects @ effects.T)[::9, ::9]
    scale = np.sqrt(np.outer(np.diag(stated), np.diag(stated)))
    # A covariance of 600 draws scatters by 1/sqrt(600) = 4 % of the variances, a variance by 6 %.
    difference = (drawn.T @ drawn / 600 - stated) / scale
    assert float(np.sqrt(np.mean(difference**2))) < 0.08
    assert float(np.mean(np.diag(difference))) == pytest.approx(0.0, abs=0.1)


def test_distance_variance_is_the_sum_of_stated_squares() -> None:
    truth = random_truth(2)
    effects = radial_effects(paper_points(truth), units(truth, 3), BUDGET)
    assert np.sum(effects**2, axis=1) == pytest.approx(np.full(1056, 0.005**2 + 0.005**2 + 0.010**2))


@cache
def trials() -> tuple[list[tuple[Identification, Floats]], list[tuple[Identification, Floats]]]:
    """Return identifications with and without the stated budget, each with its errors over u."""
    stated: list[tuple[Identification, Floats]] = []
    unstated: list[tuple[Identification, Floats]] = []
    for seed in range(SEEDS):
        truth, rng = random_truth(seed), np.random.default_rng(1000 + seed)
        noise = rng.normal(0.0, WHITE_MM, 1056) + radial_errors(rng, truth, BUDGET, 3)
        points = paper_points(truth, noise_mm=noise, sigma_mm=WHITE_MM)
        for radial, found in ((BUDGET, stated), (None, unstated)):
            one = solve(points, radial)
            n = one.layout.reflectors.stop
            found.append((one, (one.parameters[:n] - true_parameters(truth)) / one.standard_uncertainty[:n]))
    return stated, unstated


def rms(errors: list[Floats]) -> float:
    return float(np.sqrt(np.mean(np.square(errors))))


def white_only(one: Identification, errors: Floats) -> Floats:
    """Undo the widening that an unexplained misfit causes."""
    return errors * math.sqrt(one.fit.variance_ratio)


def test_errors_match_their_uncertainties_with_a_budget() -> None:
    assert 0.9 < rms([errors for _, errors in trials()[0]]) < 1.1


def test_errors_are_larger_than_white_noise_lets_expect() -> None:
    assert rms([white_only(*trial) for trial in trials()[1]]) > 1.5


def test_the_budget_leaves_no_lack_of_fit() -> None:
    lacks = [one.fit.lack_of_fit for one, _ in trials()[0]]
    # At a level of 1 % a false alarm may happen once in 40 draws.
    assert sum(lack is None or lack.significant for lack in lacks) <= 2
    assert sum(one.fit.variance_ratio != 1.0 for one, _ in trials()[0]) <= 3


def test_without_a_budget_the_fit_lacks_something() -> None:
    for one, _ in trials()[1]:
        lack = one.fit.lack_of_fit
        assert lack is not None
        assert lack.significant
        assert one.fit.variance_ratio > 1.5


def test_chi_square_is_one_a_degree_of_freedom() -> None:
    observed = [one.fit.chi2_reduced for one, _ in trials()[0] if one.fit.chi2_reduced is not None]
    # Forty values, each known to √(2 / 1008); what the amplitudes have taken up lies below that.
    assert float(np.mean(observed)) == pytest.approx(1.0, abs=0.03)


def test_weights_from_the_budget_halve_errors_of_map_1() -> None:
    """ADR 25: the same data, weighted by white errors alone and by the whole budget."""
    errors = [
        [e * one.standard_uncertainty[: e.size] for one, e in found] for found in (trials()[0], trials()[1])
    ]
    whole, white = (float(np.sqrt(np.mean([each[2:24] ** 2 for each in one]))) for one in errors)
    assert whole < 0.5 * white


def test_a_budget_without_its_errors_hardly_moves_the_estimate() -> None:
    truth = random_truth(3)
    points = paper_points(
        truth, noise_mm=np.random.default_rng(3).normal(0.0, WHITE_MM, 1056), sigma_mm=WHITE_MM
    )
    plain, budgeted = solve(points, None), solve(points, BUDGET)
    moved = (budgeted.parameters - plain.parameters) / budgeted.standard_uncertainty
    assert np.abs(moved).max() < 2.0


def test_a_budget_of_nothing_changes_nothing() -> None:
    points = replace(paper_points(random_truth(4)), sigma_mm=np.full(1056, WHITE_MM))
    none = solve(points, RadialBudget(0.0, 0.0, 0.0))
    assert none.covariance == pytest.approx(solve(points, None).covariance, rel=1e-12, abs=1e-18)


def test_shared_contributors_alone_are_refused() -> None:
    """Without the scatter of a reading they have no scale: mm² would be multiplied by the fit's own mm²."""
    points = measured(random_truth(8), commands_on_nodes(), noise_mm=0.01)
    shared = Contributor("J4 axis", "radial", 0.01, "axis-angle", "j4")
    zero = Contributor("readings", "length", 0.0)
    asked = replace(problem(points), budget=Budget((shared, zero)))
    with pytest.raises(BudgetError, match="J4 axis, which several distances share"):
        asked.solve()
    nothing = replace(asked, budget=Budget((replace(shared, u=0.0), zero))).solve()
    stated = replace(asked, points=replace(points, sigma_mm=np.full(len(points), 0.01))).solve()
    assert nothing.standard_uncertainty[0] < stated.standard_uncertainty[0]
