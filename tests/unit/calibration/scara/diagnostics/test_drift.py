"""Drifts and jumps put into distances by hand."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.diagnostics.drift import Change, changes
from catseye.calibration.scara.diagnostics.projection import projection_of
from catseye.calibration.scara.points import Points
from tests.unit.calibration.scara.diagnostics.bench import (
    commands_on_nodes,
    measured,
    problem,
    split,
    with_noise,
)
from tests.unit.calibration.scara.paper import random_truth

EXACT = measured(random_truth(6), commands_on_nodes(), sigma_mm=0.01)


def points_with(error_mm: Floats | float, seed: int = 1) -> Points:
    points = with_noise(EXACT, 0.01, seed)
    return replace(points, displacement_mm=points.displacement_mm + error_mm)


def ramp(size_mm: float) -> Floats:
    values = np.zeros(1056)
    values[352:704] = np.linspace(-0.5, 0.5, 352) * size_mm
    return values


def changes_of(points: Points) -> list[Change]:
    return changes(projection_of(problem(points).solve()))


@cache
def steady(seed: int) -> list[Change]:
    """Return what is found where nothing but noise changes."""
    return changes_of(points_with(0.0, seed))


def test_only_the_drifting_segment_is_found_with_signed_size() -> None:
    found = changes_of(points_with(ramp(0.03)))
    assert [(one.kind, one.reflector, one.segment) for one in found if one.significant] == [
        ("drift", "P2", 0)
    ]
    assert found[0].size_um == pytest.approx(30.0, abs=3.0 * found[0].u_um)
    assert sorted(one.reflector for one in found[1:]) == ["P1", "P3"]


def test_u_of_a_drift_is_the_scatter_of_repeated_measurements() -> None:
    values, u = [], []
    for seed in range(40):
        one = next(one for one in steady(seed) if one.reflector == "P1")
        values.append(one.size_um)
        u.append(one.u_um)
    assert float(np.std(values)) == pytest.approx(float(np.mean(u)), rel=0.35)
    assert abs(float(np.mean(values))) < 4.0 * float(np.mean(u)) / np.sqrt(40)


def test_each_segment_has_a_drift_of_its_own() -> None:
    grown = np.zeros(1056)
    grown[200:352] = np.linspace(-0.5, 0.5, 152) * -0.04
    found = changes_of(split(points_with(grown), 200))
    assert (found[0].kind, found[0].reflector, found[0].segment) == ("drift", "P1", 1)
    assert found[0].size_um == pytest.approx(-40.0, abs=3.0 * found[0].u_um)
    assert len(found) == 4


@pytest.mark.parametrize(("row", "step_mm"), [(500, 0.03), (950, -0.05), (180, 0.0316)])
def test_a_slip_of_the_counter_is_located(row: int, step_mm: float) -> None:
    slip = np.zeros(1056)
    end = 352 * (row // 352 + 1)
    slip[row:end] = step_mm
    found = [one for one in changes_of(points_with(slip)) if one.significant]
    assert [(one.kind, one.reflector) for one in found] == [("jump", f"P{row // 352 + 1}")]
    assert found[0].row == pytest.approx(row + 1, abs=2)
    assert found[0].within == found[0].row - end + 352
    assert found[0].size_um == pytest.approx(1e3 * step_mm, abs=3.5 * found[0].u_um)


def test_a_drift_and_a_slip_are_distinguished() -> None:
    both = ramp(0.04)
    both[800:] = -0.06
    found = [one for one in changes_of(points_with(both)) if one.significant]
    assert sorted((one.kind, one.reflector) for one in found) == [("drift", "P2"), ("jump", "P3")]


def test_nothing_changes_where_nothing_does() -> None:
    for seed in range(12):
        assert not any(one.significant for one in steady(seed))


def test_a_stated_share_of_the_measurement_counts() -> None:
    points = points_with(0.0)
    clock = np.arange(1056, dtype=np.float64) ** 3
    own = points.reflector == 1
    grown = np.where(own, (clock - clock[352]) / (clock[703] - clock[352]) * 0.04, 0.0)
    timed = replace(points, elapsed=clock / clock[-1] - 0.5, displacement_mm=points.displacement_mm + grown)
    found = [one for one in changes_of(timed) if one.significant]
    assert [(one.kind, one.reflector) for one in found] == [("drift", "P2")]
    assert found[0].size_um == pytest.approx(40.0, abs=3.0 * found[0].u_um)
