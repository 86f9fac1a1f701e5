"""Rank updates of chosen commands against recomputation and enumeration."""

from itertools import combinations
from typing import get_args

import numpy as np
import pytest

from catseye.calibration.core.design.criteria import Criterion, CriterionName
from catseye.calibration.core.design.row_choice import CommandPool, changes_with, choose_commands
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.scara.budget import Budget, Contributor
from tests.unit.calibration.scara.design.cases import RING, SIGMA_MM, SMALL, WHITE, scaled, seen_by_all, study
from tests.unit.calibration.scara.design.dense import LINKS
from tests.unit.calibration.scara.design.test_exchange import criterion_of

PLACES = RING[[1, 8]]
BLOCKS = [SMALL.block(place) for place in PLACES]


def small_pool() -> CommandPool:
    problem = study(SMALL)
    rows = [problem.rows(seen_by_all(place, len(problem.commands))) for place in PLACES]
    return CommandPool.of(rows, systematic=False)


def usefulness(pool: CommandPool, kept: Bools, criterion: Criterion) -> Floats:
    """Return by how much the criterion grows without each command."""
    return changes_with(pool, np.arange(len(pool.rows)), pool.covariance(kept), criterion, -1.0)


def dense_a(kept: Bools) -> float:
    covariance = SMALL.covariance([block[kept] for block in BLOCKS], PLACES, SIGMA_MM)
    return float(np.trace(scaled(SMALL, covariance)))


def test_value_of_some_commands_is_that_of_the_dense_problem() -> None:
    pool, criterion = small_pool(), criterion_of(study(SMALL), "A")
    kept = np.random.default_rng(3).random(len(pool.rows)) < 0.7
    assert pool.value(kept, criterion) == pytest.approx(dense_a(kept), rel=1e-5)


def shared_pool() -> tuple[CommandPool, list[Floats]]:
    """Return the small problem with a scale error and an axis-angle error of J1, and what these do to each row."""
    budget = Budget(
        (
            *WHITE.contributors,
            Contributor("wavelength", "scale", 2e-5, "common"),
            Contributor("run-out", "length", 0.030, "axis-angle", "j1", orders=1),
        )
    )
    problem = study(SMALL, budget)
    sets = [problem.rows(seen_by_all(place, len(problem.commands))) for place in PLACES]
    start = np.concatenate([LINKS, np.zeros(SMALL.arm_size - 2)])
    effects = []
    for place in PLACES:
        length = np.array([SMALL.distance(start, row, place) for row in SMALL.rows()])
        angle = np.deg2rad([SMALL.nodes1_deg[row[0]] for row in SMALL.rows()])
        effects.append(np.column_stack([2e-5 * length, 0.030 * np.cos(angle), 0.030 * np.sin(angle)]))
    return CommandPool.of(sets, systematic=True), effects


def test_shared_errors_count_as_in_the_dense_problem() -> None:
    pool, effects = shared_pool()
    kept = np.random.default_rng(3).random(len(pool.rows)) < 0.7
    blocks, shared = [block[kept] for block in BLOCKS], np.vstack([one[kept] for one in effects])
    expected = float(np.trace(scaled(SMALL, SMALL.covariance(blocks, PLACES, SIGMA_MM, shared))))
    assert pool.value(kept, criterion_of(study(SMALL), "A")) == pytest.approx(expected, rel=1e-5)


def test_a_choice_that_counts_shared_errors_is_better_beside_them() -> None:
    pool, criterion = shared_pool()[0], criterion_of(study(SMALL), "A")
    white = choose_commands(small_pool(), 24, criterion)
    assert pool.value(choose_commands(pool, 24, criterion), criterion) < 0.99 * pool.value(white, criterion)


@pytest.mark.parametrize("name", [name for name in get_args(CriterionName) if name != "E"])
def test_rank_updates_predict_leaving_a_command_out(name: CriterionName) -> None:
    pool, criterion = small_pool(), criterion_of(study(SMALL), name)
    kept = np.ones(len(pool.rows), dtype=np.bool_)
    predicted = usefulness(pool, kept, criterion)
    whole = pool.value(kept, criterion)
    for row in range(0, len(pool.rows), 5):
        without = kept.copy()
        without[row] = False
        assert predicted[row] == pytest.approx(pool.value(without, criterion) - whole, rel=1e-5, abs=1e-14)


@pytest.mark.parametrize("name", ["A", "D", "path"])
def test_rank_updates_agree_with_recomputation_over_random_exchanges(name: CriterionName) -> None:
    pool, criterion, rng = small_pool(), criterion_of(study(SMALL), name), np.random.default_rng(8)
    n = len(pool.rows)
    kept = rng.permutation(n) < 38
    compared = 0
    for _ in range(300):
        # Out with one command, in with another: each step is predicted before, and computed anew after.
        for sign in (-1.0, 1.0):
            rows = np.flatnonzero(kept if sign < 0.0 else ~kept)
            row = int(rng.choice(rows))
            predicted = changes_with(pool, rows, pool.covariance(kept), criterion, sign)[rows == row][0]
            changed = kept.copy()
            changed[row] = sign > 0.0
            if np.isinf(predicted):
                break
            real = pool.value(changed, criterion) - pool.value(kept, criterion)
            assert predicted == pytest.approx(real, rel=1e-4, abs=1e-9 * abs(pool.value(kept, criterion)))
            kept, compared = changed, compared + 1
    assert compared > 500


@pytest.mark.parametrize("name", ["A", "D", "path"])
def test_no_exchange_of_one_command_improves_the_least_useful_one(name: CriterionName) -> None:
    pool, criterion = small_pool(), criterion_of(study(SMALL), name)
    kept = choose_commands(pool, 20, criterion)
    assert kept.sum() == 20
    value = pool.value(kept, criterion)
    out = int(np.argmin(np.where(kept, usefulness(pool, kept, criterion), np.inf)))
    for new in np.flatnonzero(~kept):
        trial = kept.copy()
        trial[out], trial[new] = False, True
        assert pool.value(trial, criterion) >= value - 1e-7 * abs(value)


def test_dropping_two_commands_is_near_the_exhaustive_optimum() -> None:
    pool, criterion = small_pool(), criterion_of(study(SMALL), "A")
    n = len(pool.rows)

    def without(pair: tuple[int, ...]) -> float:
        kept = np.ones(n, dtype=np.bool_)
        kept[list(pair)] = False
        return pool.value(kept, criterion)

    best = min(without(pair) for pair in combinations(range(n), 2))
    assert dense_a(choose_commands(pool, n - 2, criterion)) <= 1.01 * best


def test_every_map_value_stays_determined_however_few_are_asked_for() -> None:
    pool, criterion = small_pool(), criterion_of(study(SMALL), "D")
    kept = choose_commands(pool, 1, criterion)
    rows = [row for row, keep in zip(SMALL.rows(), kept, strict=True) if keep]
    assert {(i1, s1) for i1, _, s1, _ in rows} == {(i, s) for i in range(4) for s in (1, -1)}
    assert {(i2, s2) for _, i2, _, s2 in rows} == {(i, s) for i in range(3) for s in (1, -1)}
    assert np.isfinite(pool.value(kept, criterion))
