"""Information of places against the dense problem with all its nuisances."""

import math
from typing import get_args

import numpy as np
import pytest
from scipy import linalg

from catseye.calibration.core.design.criteria import CriterionName, covariances
from catseye.calibration.core.design.information import Information
from catseye.calibration.core.errors import BudgetError, UnidentifiableError
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.design.criterion import Criterion
from catseye.calibration.scara.design.sight import Sight
from catseye.calibration.scara.planar import forward
from tests.unit.calibration.scara.design.cases import RING, SIGMA_MM, SMALL, WHITE, seen_by_all, study
from tests.unit.calibration.scara.design.dense import LINKS, DenseArm
from tests.unit.calibration.scara.drifting import course
from tests.unit.calibration.scara.paper import NODES1_DEG, NODES2_DEG, NOMINAL_REFLECTORS

PAPER = DenseArm(tuple(NODES1_DEG), tuple(NODES2_DEG))


def information(arm: DenseArm, places: Floats, budget: Budget = WHITE) -> Information:
    problem = study(arm, budget)
    parts = [problem.rows(seen_by_all(place, len(problem.commands))).information() for place in places]
    total = parts[0]
    for part in parts[1:]:
        total = total + part
    return total


@pytest.mark.parametrize("places", [RING[[2]], RING[[1, 8]], RING[[0, 5, 11]]])
def test_covariance_is_that_of_the_dense_problem(places: Floats) -> None:
    covariance = study(SMALL).covariance(information(SMALL, places), systematic=False)
    mine = study(SMALL).arm(covariance).covariance
    dense = SMALL.covariance([SMALL.block(place) for place in places], places, SIGMA_MM)
    scale = np.sqrt(np.diag(dense))
    assert np.abs((mine - dense) / np.outer(scale, scale)).max() < 1e-6


@pytest.mark.parametrize(
    ("chosen", "largest_mdeg"),
    [((0, 1, 2), (0.90, 1.5)), ((0, 2), (1.0, 1.8)), ((1,), (2.7, 2.8))],
)
def test_paper_layout_has_the_known_uncertainties(
    chosen: tuple[int, ...], largest_mdeg: tuple[float, float]
) -> None:
    """15.6 µm white: the published check of the paper's layout with three, two and one reflector."""
    problem = study(PAPER)
    found = information(PAPER, NOMINAL_REFLECTORS[list(chosen)])
    u = np.sqrt(np.diag(problem.arm(problem.covariance(found, systematic=False)).covariance))
    maps = [1e3 * np.rad2deg(u[part].max()) for part in (problem.layout.map1, problem.layout.map2)]
    assert [float(f"{value:.2g}") for value in maps] == list(largest_mdeg)


def test_systematic_contributors_match_the_dense_problem() -> None:
    """A scale error and an axis-angle error of J1 by their definitions: columns of effects, one fit."""
    places = RING[[1, 8]]
    budget = Budget(
        (
            *WHITE.contributors,
            Contributor("scale", "scale", 2e-6, "common"),
            Contributor("length", "length", 0.01, "axis-angle", "j1", orders=1),
        )
    )
    problem = study(SMALL, budget)
    mine = problem.arm(problem.covariance(information(SMALL, places, budget), systematic=True)).covariance
    rows = SMALL.rows()
    arm = np.concatenate([[325.0, 225.0], np.zeros(SMALL.arm_size - 2)])
    length = np.array([SMALL.distance(arm, row, place) for place in places for row in rows])
    angle = np.tile(np.deg2rad([SMALL.nodes1_deg[row[0]] for row in rows]), 2)
    effects = np.column_stack([2e-6 * length, 0.01 * np.cos(angle), 0.01 * np.sin(angle)])
    blocks = [SMALL.block(place) for place in places]
    expected = SMALL.covariance(blocks, places, SIGMA_MM, effects)
    scale = np.sqrt(np.diag(expected))
    assert np.abs((mine - expected) / np.outer(scale, scale)).max() < 1e-5


def test_drifts_match_the_dense_problem_in_measuring_order() -> None:
    """A line and a cosine over the rows of each reflector, for the zero and for both links."""
    places = RING[[1, 8]]
    zero = Contributor("zero", "length", 0.02, "time", orders=2)
    warmth = Contributor("warmth", "links", 2e-5, "time", orders=1)
    budget = Budget((*WHITE.contributors, zero, warmth))
    problem = study(SMALL, budget)
    mine = problem.arm(problem.covariance(information(SMALL, places, budget), systematic=True)).covariance
    blocks = [SMALL.block(place) for place in places]
    n = len(SMALL.rows())
    first, second = (np.array([course(order, i / (n - 1)) for i in range(n)]) for order in (1, 2))
    # Variances of the zero fall as 1 to 1/4 and add up to u².
    own = [
        np.column_stack(
            [
                0.02 * math.sqrt(0.8) * first,
                0.02 * math.sqrt(0.2) * second,
                2e-5 * (block[:, 0] * LINKS[0] + block[:, 1] * LINKS[1]) * first,
            ]
        )
        for block in blocks
    ]
    # The order of reflectors is open, so that each has processes of its own.
    expected = SMALL.covariance(blocks, places, SIGMA_MM, linalg.block_diag(*own))
    scale = np.sqrt(np.diag(expected))
    assert np.abs((mine - expected) / np.outer(scale, scale)).max() < 1e-5
    without = SMALL.covariance(blocks, places, SIGMA_MM)
    assert float(np.max(scale / np.sqrt(np.diag(without)))) > 1.05


def test_a_break_of_the_beam_costs_a_dead_path() -> None:
    problem = study(SMALL)
    n = len(problem.commands)
    whole = seen_by_all(RING[4], n)
    halves = Sight(whole.xy_mm, 0.0, whole.seen, (np.arange(n) >= n // 2).astype(np.int64), 1, "")
    kept, lost = (problem.rows(sight).information().matrix for sight in (whole, halves))
    values = np.linalg.eigvalsh(kept - lost)
    # One more unknown takes away a single direction's information.
    assert values[-1] > 1e-3 * np.linalg.eigvalsh(kept)[-1] / n
    assert np.abs(values[:-1]).max() < 1e-6 * values[-1] + 1e-6 * np.linalg.eigvalsh(kept)[-1]


def test_commands_without_sight_do_not_count() -> None:
    problem = study(SMALL)
    n = len(problem.commands)
    seen = np.arange(n) % 3 != 0
    partly = Sight(RING[4], 0.0, seen, np.where(seen, 0, -1), 0, "")
    mine = problem.rows(partly).information().matrix
    block = SMALL.block(RING[4], [row for row, keep in zip(SMALL.rows(), seen, strict=True) if keep])
    arm, nuisance = block[:, : SMALL.arm_size] @ problem.basis, block[:, SMALL.arm_size :]
    residual = arm - nuisance @ np.linalg.lstsq(nuisance, arm, rcond=None)[0]
    expected = residual.T @ residual / SIGMA_MM**2
    assert np.abs(mine - expected).max() < 1e-5 * np.abs(expected).max()


def test_repeats_average_white_errors_only() -> None:
    budget = Budget((*WHITE.contributors, Contributor("scale", "scale", 2e-6, "common")))
    problem = study(SMALL, budget)
    once = information(SMALL, RING[[1, 8]], budget)
    four = once.times(4)
    white = problem.covariance(once, systematic=False)
    systematic = problem.covariance(once, systematic=True) - white
    assert np.allclose(problem.covariance(four, systematic=False), white / 4.0, rtol=1e-9, atol=0.0)
    # Differences of covariances, so rounding counts against their largest element.
    left = problem.covariance(four, systematic=True) - white / 4.0
    assert np.allclose(left, systematic, rtol=0.0, atol=1e-6 * np.abs(systematic).max())


def test_a_node_that_nobody_sees_is_named() -> None:
    problem = study(SMALL)
    seen = np.array([row[0] != 3 or row[2] > 0 for row in SMALL.rows()])
    blind = Sight(RING[4], 0.0, seen, np.where(seen, 0, -1), 0, "")
    with pytest.raises(UnidentifiableError, match=r"no point touches Δθ1\(20°, −\)"):
        problem.require_determined([blind])


def test_one_node_of_j2_leaves_the_links_undetermined() -> None:
    single = DenseArm((-100.0, -60.0, -20.0, 20.0), (60.0,))
    problem = study(single)
    with pytest.raises(UnidentifiableError, match="L1"):
        problem.require_determined([seen_by_all(place, len(problem.commands)) for place in RING[[2, 9]]])


@pytest.mark.parametrize("sigma_mm", [SIGMA_MM, 1e-4, 1e-6])
def test_what_is_undetermined_stays_so_however_good_the_distances(sigma_mm: float) -> None:
    single = DenseArm((-100.0, -60.0, -20.0, 20.0), (60.0,))
    problem = study(single, Budget((Contributor("white", "length", sigma_mm),)))
    brought = [
        problem.rows(seen_by_all(place, len(problem.commands))).information() for place in RING[[2, 9]]
    ]
    covariance = covariances((brought[0] + brought[1]).matrix)
    for name in get_args(CriterionName):
        criterion = Criterion(name, single.arm_size, np.eye(single.arm_size - 1))
        assert np.isinf(criterion.value(covariance))


def test_a_place_under_the_j4_axis_keeps_other_commands_information() -> None:
    problem = study(SMALL)
    theta1, theta2 = problem.commands.theta1_rad, problem.commands.theta2_rad
    positions = forward(theta1, theta2, problem.link1_mm, problem.link2_mm)
    on_the_way = positions[7]
    seen = np.hypot(*(positions - on_the_way).T) > 1.0
    assert 0 < seen.sum() < len(seen)
    sight = Sight(on_the_way, 0.0, seen, np.where(seen, 0, -1), 0, "")
    found = problem.rows(sight).information().matrix
    block = SMALL.block(on_the_way, [row for row, keep in zip(SMALL.rows(), seen, strict=True) if keep])
    arm, nuisance = block[:, : SMALL.arm_size] @ problem.basis, block[:, SMALL.arm_size :]
    residual = arm - nuisance @ np.linalg.lstsq(nuisance, arm, rcond=None)[0]
    expected = residual.T @ residual / SIGMA_MM**2
    assert np.abs(found - expected).max() < 1e-5 * np.abs(expected).max()


def test_exact_distances_are_refused() -> None:
    problem = study(SMALL, Budget((Contributor("scale", "scale", 1e-6, "common"),)))
    with pytest.raises(BudgetError, match="exact"):
        problem.rows(seen_by_all(RING[0], len(problem.commands)))


def test_a_drift_leaves_links_and_maps_less_known() -> None:
    zero = Contributor("zero", "length", 0.05, "time", orders=7)
    moved = Contributor("nests", "reflector", 0.05, "segment")
    places = RING[[1, 5, 8]]
    u = [
        np.sqrt(np.diag(study(SMALL).covariance(information(SMALL, places, budget), systematic=True)))
        for budget in (WHITE, Budget((*WHITE.contributors, zero)), Budget((*WHITE.contributors, moved)))
    ]
    assert float(np.min(u[1] / u[0])) >= 1.0 - 1e-9
    assert float(np.max(u[1] / u[0])) > 1.1
    # Reflectors seen in one segment each have places of their own, wherever they stand.
    assert u[2] == pytest.approx(u[0], rel=1e-6)
