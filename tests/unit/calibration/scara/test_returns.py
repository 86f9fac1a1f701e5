"""Returns to the first pose of a series show a drift of the zero; the drift is drawn here, of known size."""

import math
from dataclasses import replace
from functools import cache

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.found_drift import found_drifts
from catseye.calibration.scara.points import Points, concatenated, without_short_segments
from tests.unit.calibration.scara.paper import paper_points, random_truth
from tests.unit.calibration.scara.samples import identified

SETS = 16
SERIES = 352
WHITE_MM, DRIFT_MM, ORDERS = 0.010, 0.020, 31
OCTAVES = 5
BUDGET = Budget((Contributor("drift", "length", DRIFT_MM, "time", orders=ORDERS, spectrum=(1.0,) * OCTAVES),))


def with_returns(points: Points, every: int) -> Points:
    """Return points with the first one of a series measured again after so many of it; 0 for never."""
    rows, returned = list[int](), list[bool]()
    for row in range(len(points)):
        rows.append(row)
        returned.append(False)
        if every and (row % SERIES + 1) % every == 0:
            rows.append(row - row % SERIES)
            returned.append(True)
    return replace(points.rows(np.array(rows)), returned=np.array(returned))


def drawn_drift(seed: int, share: Floats) -> Floats:
    """Return a drift at shares 0…1 of the measurement, mm: a steady one, and cosines as of a random walk."""
    order = np.arange(1.0, ORDERS + 1.0)
    rms = DRIFT_MM * np.sqrt(1.0 / order**2 / float(np.sum(1.0 / order**2)))
    sizes = np.random.default_rng(50 + seed).normal(0.0, rms)
    steady = math.sqrt(12.0) * (0.5 - share) * sizes[0]
    return np.asarray(steady + math.sqrt(2.0) * np.cos(np.pi * np.outer(share, order[1:])) @ sizes[1:])


@cache
def drifting(every: int) -> tuple[Floats, Floats, Floats]:
    """Return errors of the drift's change over u, its u, and errors of links and maps over u, of all sets."""
    errors, u, of_tables = [], [], []
    for seed in range(SETS):
        truth = random_truth(seed)
        points = with_returns(paper_points(truth, sigma_mm=WHITE_MM), every)
        drift = drawn_drift(seed, np.linspace(0.0, 1.0, len(points)))
        noise = np.random.default_rng(90 + seed).normal(0.0, WHITE_MM, len(points))
        measured = replace(points, displacement_mm=points.displacement_mm + drift + noise)
        one = identified(measured, budget=BUDGET)
        (found,) = found_drifts(one)
        errors.append((found.change - (drift[-1] - drift[0])) / found.u_change)
        u.append(found.u_change)
        of_tables.append((one.parameters[:40] - truth.table_vector()) / one.standard_uncertainty[:40])
    return np.array(errors), np.array(u), np.concatenate(of_tables)


def test_returns_make_the_drift_better_known() -> None:
    # Half way and at the end of each series, as a run does it by default: six of 1062 distances.
    assert float((drifting(176)[1] / drifting(0)[1]).max()) < 0.8


def test_errors_stay_within_u_with_returns() -> None:
    errors, _, of_tables = drifting(176)
    # The rms of 16 independent errors lies between 0.57 and 1.46 in 99 of 100 cases (chi-square).
    assert 0.57 < float(np.sqrt(np.mean(errors**2))) < 1.46
    # 640 correlated errors in 16 arms.
    assert float(np.mean(np.abs(of_tables) < 1.96)) > 0.9


def test_a_return_counts_as_any_distance() -> None:
    points = with_returns(paper_points(random_truth(1), sigma_mm=WHITE_MM), 176)
    marked, unmarked = identified(points), identified(replace(points, returned=None))
    assert marked.parameters.tolist() == unmarked.parameters.tolist()
    assert (marked.points.returns, unmarked.points.returns) == (6, None)


def test_only_returns_that_are_used_are_counted() -> None:
    points = with_returns(paper_points(random_truth(1), sigma_mm=WHITE_MM), 176)
    # The last return alone is a segment that is too short.
    lonely = np.where(np.arange(len(points)) == len(points) - 1, 3, points.dead_path)
    kept, _ = without_short_segments(
        replace(points, dead_path=lonely, dead_paths=(*points.dead_paths, ("P3", 1)))
    )
    assert (points.returns, kept.returns) == (6, 5)


def test_tables_joined_know_returns_if_all_do() -> None:
    points = with_returns(paper_points(random_truth(1)), 176)
    assert concatenated([points, points]).returns == 12
    assert concatenated([points, replace(points, returned=None)]).returns is None
