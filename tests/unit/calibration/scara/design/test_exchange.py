"""The exchange against every layout, judged by a dense Jacobian that is written independently."""

from itertools import combinations
from typing import get_args

import numpy as np
import pytest

from catseye.calibration.core.design.criteria import CriterionName
from catseye.calibration.core.design.exchange import Pool, exchange, greedy_start, random_start
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.design.candidates import apart
from catseye.calibration.scara.design.criterion import Criterion
from catseye.calibration.scara.design.study import Study
from tests.unit.calibration.scara.design.cases import RING, SIGMA_MM, SMALL, WHITE, scaled, seen_by_all, study

WHOLE = Budget((*WHITE.contributors, Contributor("scale", "scale", 1e-5, "common")))
NAMES = get_args(CriterionName)


def criterion_of(problem: Study, name: CriterionName) -> Criterion:
    gradient = position_gradient(problem)
    return Criterion(name, problem.layout.arm_size, gradient)


def position_gradient(problem: Study) -> Floats:
    """Return derivatives of x and y at every third command, written out: shape (q, f)."""
    rows = []
    for i1, i2, s1, s2 in SMALL.rows()[::3]:
        a = np.deg2rad(SMALL.nodes1_deg[i1])
        b = a + np.deg2rad(SMALL.nodes2_deg[i2])
        one = 2 + i1 + (0 if s1 > 0 else 4)
        two = 10 + i2 + (0 if s2 > 0 else 3)
        x, y = np.zeros(SMALL.arm_size), np.zeros(SMALL.arm_size)
        x[:2], y[:2] = (np.cos(a), np.cos(b)), (np.sin(a), np.sin(b))
        x[one], y[one] = -325.0 * np.sin(a) - 225.0 * np.sin(b), 325.0 * np.cos(a) + 225.0 * np.cos(b)
        x[two], y[two] = -225.0 * np.sin(b), 225.0 * np.cos(b)
        rows += [x, y]
    return np.asarray(np.array(rows) @ problem.basis)


def pool_of(problem: Study, places: Floats, systematic: bool = False) -> Pool:
    brought = [problem.rows(seen_by_all(place, len(problem.commands))).information() for place in places]
    return Pool.of(brought, apart(places, 100.0), systematic=systematic)


def dense_a(blocks: list[Floats], places: Floats) -> float:
    """Return the trace of the covariance by the dense problem, links as angles at full reach."""
    return float(np.trace(scaled(SMALL, SMALL.covariance(blocks, places, SIGMA_MM))))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_optimum_matches_exhaustive_search_with_the_dense_jacobian(count: int) -> None:
    problem = study(SMALL)
    pool, criterion = pool_of(problem, RING), criterion_of(problem, "A")
    blocks = [SMALL.block(place) for place in RING]
    every = {
        chosen: dense_a([blocks[k] for k in chosen], RING[list(chosen)])
        for chosen in combinations(range(len(RING)), count)
    }
    best = min(every.values())
    found = []
    # As many starts as the command takes.
    for number in range(12):
        start = random_start(pool, count, np.random.default_rng((1, count, number)))
        assert start is not None
        found.append(exchange(pool, start, criterion))
    for one in found:
        assert one.value == pytest.approx(every[tuple(int(k) for k in one.places)], rel=1e-5)
    assert min(one.value for one in found) <= 1.01 * best


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("budget", [WHITE, WHOLE])
def test_no_single_exchange_improves_what_was_found(name: CriterionName, budget: Budget) -> None:
    """Leaving places out by their bound must not lose the best exchange."""
    problem = study(SMALL, budget)
    pool, criterion = pool_of(problem, RING, systematic=budget is WHOLE), criterion_of(problem, name)
    start = greedy_start(pool, 2, criterion)
    assert start is not None
    found = exchange(pool, start, criterion)
    others = [
        np.array([kept, new])
        for kept in found.places
        for new in range(len(RING))
        if new not in found.places and pool.compatible[kept, new]
    ]
    best = min(pool.value(other, criterion) for other in others)
    assert found.value <= best + 1e-8 * abs(best)
    assert found.value == pytest.approx(pool.value(found.places, criterion), rel=1e-12)


def test_never_worse_than_where_it_started() -> None:
    problem = study(SMALL)
    pool, criterion = pool_of(problem, RING), criterion_of(problem, "D")
    rng = np.random.default_rng(2)
    for _ in range(10):
        start = random_start(pool, 3, rng)
        assert start is not None
        assert exchange(pool, start, criterion).value <= pool.value(start, criterion)


def test_places_keep_their_distance() -> None:
    problem = study(SMALL)
    places = np.vstack([RING[:4], RING[:4] + 5.0])
    pool, criterion = pool_of(problem, places), criterion_of(problem, "A")
    start = greedy_start(pool, 3, criterion)
    assert start is not None
    chosen = places[exchange(pool, start, criterion).places]
    gaps = [float(np.hypot(*(a - b))) for a, b in combinations(chosen, 2)]
    assert min(gaps) >= 100.0


def test_without_room_there_is_no_start() -> None:
    problem = study(SMALL)
    pool = pool_of(problem, RING[0] + np.array([[0.0, 0.0], [5.0, 0.0], [0.0, 5.0]]))
    assert random_start(pool, 2, np.random.default_rng(1)) is None
    assert greedy_start(pool, 2, criterion_of(problem, "A")) is None


def test_same_seed_same_start() -> None:
    pool = pool_of(study(SMALL), RING)
    starts = [random_start(pool, 3, np.random.default_rng((1, 3, 7))) for _ in range(2)]
    first, again = starts
    assert first is not None
    assert again is not None
    assert np.array_equal(first, again)
