"""The layout that the searches find, against every layout of the cell's own places."""

from itertools import combinations
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from app.analysis.design_layouts import candidate_places
from app.analysis.design_problem import Wish, problem_of
from app.cell.bench import bench_of
from app.cell.load import load_cell
from app.cell.template import TEMPLATE
from calibration.design.criteria import CriterionName
from calibration.design.exchange import exchange, greedy_start, random_start
from calibration.types import Floats


def criterion_of(name: CriterionName, covariance: Floats, gradient: Floats) -> float:
    """Return a criterion from its definition."""
    if name == "A":
        return float(np.trace(covariance))
    if name == "D":
        return float(np.linalg.slogdet(covariance)[1])
    if name == "E":
        return float(np.linalg.norm(covariance, 2))
    return float(np.einsum("qi,ij,qj->q", gradient, covariance, gradient).max())


@pytest.mark.parametrize("systematic", [True, False])
@pytest.mark.parametrize("name", get_args(CriterionName))
def test_three_reflectors_are_the_best_of_all_threes(
    tmp_path: Path, name: CriterionName, systematic: bool
) -> None:
    (tmp_path / "cell.toml").write_text(TEMPLATE)
    cell = load_cell(tmp_path / "cell.toml").cell
    problem = problem_of(bench_of(cell), cell.uncertainty.budget, Wish(name, systematic=systematic))
    places = candidate_places(problem, 50)
    brought = [problem.study.rows(sight).information() for sight in places.allowed]
    xy = np.array([sight.xy_mm for sight in places.allowed])
    values = []
    for three in combinations(range(len(xy)), 3):
        if min(np.hypot(*(xy[i] - xy[j])) for i, j in combinations(three, 2)) < 100.0:
            continue
        covariance: Floats = np.linalg.inv(np.sum([brought[k].matrix for k in three], axis=0))
        if systematic:
            shifts = covariance @ np.sum([brought[k].effects for k in three], axis=0)
            covariance = covariance + shifts @ shifts.T
        values.append(criterion_of(name, covariance, problem.criterion.gradient))
    assert len(values) > 500
    pool, criterion = places.pool, problem.criterion
    drawn = [random_start(pool, 3, np.random.default_rng((1, 3, number))) for number in range(12)]
    starts = [greedy_start(pool, 3, criterion), *drawn]
    found = min(exchange(pool, start, criterion).value for start in starts if start is not None)
    reached, best = (problem.criterion.shown(value) for value in (found, min(values)))
    # The issue allows one percent; an exchange from 13 starts finds the optimum of so few places itself.
    assert reached == pytest.approx(best, rel=1e-6)
