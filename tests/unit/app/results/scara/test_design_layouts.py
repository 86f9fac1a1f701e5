"""The layout that the searches find, against every layout of the cell's own places."""

import tomllib
from functools import cache
from itertools import combinations
from typing import get_args

import numpy as np
import pytest

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.results.scara.design.layouts import Places, candidate_places
from catseye.app.results.scara.design.problem import Problem, Wish, problem_of
from catseye.calibration.core.design.criteria import CriterionName
from catseye.calibration.core.design.exchange import exchange, greedy_start, random_start
from catseye.calibration.core.types import Floats


def criteria_of(name: CriterionName, covariances: Floats, gradient: Floats) -> Floats:
    """Return a criterion of each covariance from its definition."""
    values: Floats
    if name == "A":
        values = np.trace(covariances, axis1=1, axis2=2)
    elif name == "D":
        values = np.linalg.slogdet(covariances)[1]
    elif name == "E":
        values = np.linalg.norm(covariances, 2, axis=(1, 2))
    else:
        values = np.array([np.einsum("qi,ij,qj->q", gradient, one, gradient).max() for one in covariances])
    return values


@cache
def every_three(*, systematic: bool) -> tuple[Problem, Places, Floats]:
    """Return the template's problem, its places, and the covariance of every layout of three of them."""
    cell = Cell.model_validate(tomllib.loads(TEMPLATE))
    problem = problem_of(scara_bench_of(cell), cell.uncertainty.budget, Wish("path", systematic=systematic))
    places = candidate_places(problem, 50)
    brought = [problem.study.rows(sight).information() for sight in places.allowed]
    xy = np.array([sight.xy_mm for sight in places.allowed])
    covariances = []
    for three in combinations(range(len(xy)), 3):
        if min(np.hypot(*(xy[i] - xy[j])) for i, j in combinations(three, 2)) < 100.0:
            continue
        matrix: Floats = np.sum([brought[k].matrix for k in three], axis=0)
        if systematic:
            effects = np.sum([brought[k].effects for k in three], axis=0)
            sources = np.sum([brought[k].sources for k in three], axis=0)
            matrix = matrix - effects @ np.linalg.inv(np.eye(len(sources)) + sources) @ effects.T
        covariances.append(np.linalg.inv(matrix))
    return problem, places, np.array(covariances)


@pytest.mark.parametrize("systematic", [True, False])
@pytest.mark.parametrize("name", get_args(CriterionName))
def test_three_reflectors_are_the_best_of_all_threes(name: CriterionName, systematic: bool) -> None:
    problem, places, covariances = every_three(systematic=systematic)
    pool, criterion = places.pool, problem.with_criterion(name)
    values = criteria_of(name, covariances, criterion.gradient)
    assert values.size > 500
    drawn = [random_start(pool, 3, np.random.default_rng((1, 3, number))) for number in range(12)]
    starts = [greedy_start(pool, 3, criterion), *drawn]
    found = min(exchange(pool, start, criterion).value for start in starts if start is not None)
    reached, best = (criterion.shown(value) for value in (found, float(values.min())))
    # The issue allows one percent; an exchange from 13 starts finds the optimum of so few places itself.
    assert reached == pytest.approx(best, rel=1e-6)
