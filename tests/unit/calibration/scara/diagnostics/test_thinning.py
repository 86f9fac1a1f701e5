"""Evenly spread distances of long tables."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.scara.diagnostics import thinning
from tests.unit.calibration.scara.diagnostics.bench import commands_on_nodes, measured, problem, split
from tests.unit.calibration.scara.paper import random_truth


def test_every_segment_keeps_its_share(monkeypatch: pytest.MonkeyPatch) -> None:
    points = split(measured(random_truth(6), commands_on_nodes(), noise_mm=0.01, sigma_mm=0.01), 347)
    found = problem(points).solve()
    monkeypatch.setattr(thinning, "MOST_ROWS", 300)
    few = thinning.thinned(found)
    # A fourth of 347, 5, 352 and 352 distances, the first of each segment among them.
    assert np.bincount(few.points.dead_path).tolist() == [87, 88, 88, 2]
    assert few.residuals_mm.size == len(few.points) == 265
    assert few.points.dead_paths == points.dead_paths


def test_short_tables_stay_whole() -> None:
    points = measured(random_truth(6), commands_on_nodes(), noise_mm=0.01, sigma_mm=0.01)
    found = replace(problem(points).solve())
    assert thinning.thinned(found) is found
