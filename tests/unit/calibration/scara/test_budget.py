"""What each contributor does to the distances, against sums written out here point by point."""

import math
from typing import get_args

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import (
    Axis,
    Budget,
    Contributor,
    Correlation,
    Kind,
)
from catseye.calibration.scara.budget_effects import (
    Geometry,
    combined_white_mm,
    effects,
    systematic_effects,
    white_mm,
)
from catseye.calibration.scara.distance_model import distance_model
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.points import Points
from tests.unit.calibration.scara.paper import (
    NODES1_DEG,
    NODES2_DEG,
    Truth,
    paper_points,
    random_truth,
    sequence,
    true_position,
)

TRUTH = random_truth(6)
POINTS = paper_points(TRUTH, reflectors=2)
COMMANDS = [(row, j) for j in range(2) for row in sequence()]


def geometry() -> Geometry:
    nodes = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)
    layout = Layout("error-map", *nodes, POINTS.reflector_names, POINTS.dead_paths)
    zeros = [math.dist(true_position(TRUTH, sequence()[0]), TRUTH.reflectors[j]) for j in range(2)]
    places = TRUTH.reflectors[:2].ravel()
    parameters = np.concatenate([TRUTH.table_vector(), places, np.array(zeros)])
    return distance_model(layout, POINTS).geometry(parameters)


def length(truth: Truth, k: int, turned: tuple[float, float] = (0.0, 0.0)) -> float:
    """Return the true length of distance k with both joints turned a little further, rad."""
    (i1, i2, s1, s2), j = COMMANDS[k]
    one = math.radians(NODES1_DEG[i1]) + truth.map1[s1][i1] + turned[0]
    both = one + math.radians(NODES2_DEG[i2]) + truth.map2[s2][i2] + turned[1]
    x = truth.link1_mm * math.cos(one) + truth.link2_mm * math.cos(both)
    y = truth.link1_mm * math.sin(one) + truth.link2_mm * math.sin(both)
    return math.dist((x, y), truth.reflectors[j])


def beam(k: int) -> tuple[float, float]:
    row, j = COMMANDS[k]
    x, y = true_position(TRUTH, row)
    away = (x - TRUTH.reflectors[j][0], y - TRUTH.reflectors[j][1])
    return away[0] / math.hypot(*away), away[1] / math.hypot(*away)


def same_pose(k: int, m: int) -> bool:
    return COMMANDS[k][0][:2] == COMMANDS[m][0][:2]


def covariance(one: Contributor) -> Floats:
    found = effects(one, geometry())
    return np.asarray(found @ found.T, dtype=np.float64)


ROWS = range(0, len(COMMANDS), 61)


def test_a_pose_length_correlates_only_distances_of_that_pose() -> None:
    found = covariance(Contributor("c", "length", 0.003, "pose"))
    for k in ROWS:
        for m in range(0, len(COMMANDS), 17):
            assert found[k, m] == pytest.approx(0.003**2 if same_pose(k, m) else 0.0, abs=1e-18)


def test_a_position_common_to_a_pose_acts_along_each_beam() -> None:
    found = covariance(Contributor("c", "position", 0.004, "pose"))
    for k in ROWS:
        for m in range(0, len(COMMANDS), 17):
            along = sum(a * b for a, b in zip(beam(k), beam(m), strict=True)) if same_pose(k, m) else 0.0
            assert found[k, m] == pytest.approx(0.004**2 * along, abs=1e-12)


def test_a_common_scale_stretches_every_displacement() -> None:
    (column,) = effects(Contributor("c", "scale", 2e-6, "common"), geometry()).T
    assert column == pytest.approx(2e-6 * POINTS.displacement_mm)


def test_a_common_angle_moves_each_distance_by_its_derivative() -> None:
    for axis, turn in (("j1", (1e-6, 0.0)), ("j2", (0.0, 1e-6))):
        known: Axis = "j1" if axis == "j1" else "j2"
        (column,) = effects(Contributor("c", "angle", 1e-5, "common", known), geometry()).T
        for k in ROWS:
            back = (-turn[0], -turn[1])
            slope = (length(TRUTH, k, turn) - length(TRUTH, k, back)) / 2e-6
            assert column[k] == pytest.approx(1e-5 * slope, abs=1e-11)


def test_an_axis_angle_error_is_a_sum_of_harmonics() -> None:
    found = covariance(Contributor("c", "length", 0.005, "axis-angle", "j2", orders=3))
    for k in ROWS:
        for m in range(0, len(COMMANDS), 29):
            difference = math.radians(NODES2_DEG[COMMANDS[k][0][1]] - NODES2_DEG[COMMANDS[m][0][1]])
            expected = 0.005**2 / 3 * sum(math.cos(order * difference) for order in (1, 2, 3))
            assert found[k, m] == pytest.approx(expected, abs=1e-15)


def test_white_contributors_add_up_in_squares() -> None:
    lines = (
        Contributor("a", "length", 0.010),
        Contributor("b", "position", 0.004),
        Contributor("c", "scale", 5e-6),
        Contributor("d", "angle", 2e-6, axis="j1"),
        Contributor("e", "direction", 7e-4),
    )
    found = combined_white_mm(Budget((*lines, Contributor("f", "scale", 1e-3, "common"))), geometry())
    for k in ROWS:
        slope = (length(TRUTH, k, (1e-6, 0.0)) - length(TRUTH, k, (-1e-6, 0.0))) / 2e-6
        cosine = length(TRUTH, k) * 7e-4**2 / math.sqrt(2.0)
        parts = (0.010, 0.004, 5e-6 * POINTS.displacement_mm[k], 2e-6 * slope, cosine)
        assert found[k] == pytest.approx(math.hypot(*parts), rel=1e-6)


def test_a_cosine_error_scatters_as_drawn() -> None:
    drawn = np.random.default_rng(2).normal(0.0, 2e-3, 200_000)
    stated = white_mm(Contributor("c", "direction", 2e-3), geometry())[5]
    # A standard deviation of squares of normal draws scatters by sqrt(3.5 / n) = 0.4 %.
    assert stated == pytest.approx(float(np.std(length(TRUTH, 5) * (1.0 - np.cos(drawn)))), rel=0.02)


def test_no_budget_and_a_white_one_leave_nothing_in_common() -> None:
    assert systematic_effects(None, geometry()).shape == (len(POINTS), 0)
    assert systematic_effects(Budget((Contributor("c", "length", 1.0),)), geometry()).shape[1] == 0


@pytest.mark.parametrize("kind", get_args(Kind))
@pytest.mark.parametrize("correlation", get_args(Correlation))
def test_every_combination_is_propagated_or_refused(kind: Kind, correlation: Correlation) -> None:
    possible = {
        ("length", "reading"), ("length", "pose"), ("length", "axis-angle"), ("length", "common"),
        ("scale", "reading"), ("scale", "common"),
        ("position", "reading"), ("position", "pose"), ("position", "common"),
        ("angle", "reading"), ("angle", "axis-angle"), ("angle", "common"),
        ("between-nodes", "axis-angle"), ("radial", "axis-angle"), ("direction", "reading"),
        ("length", "time"), ("scale", "time"), ("links", "time"), ("reflector", "segment"),
    }  # fmt: skip
    if (kind, correlation) not in possible:
        with pytest.raises(ValueError, match="cannot be correlated per"):
            Contributor("c", kind, 1e-3, correlation, "j1")
        return
    one = Contributor("c", kind, 1e-3, correlation, "j1")
    points: Points = POINTS
    if correlation == "reading":
        assert np.all(white_mm(one, geometry()) >= 0.0)
    else:
        found = effects(one, geometry())
        assert found.shape[0] == len(points)
        # The paper's commands are all at nodes.
        assert bool(np.any(found)) == (kind != "between-nodes")


def test_an_axis_has_to_be_named_where_one_is_meant() -> None:
    with pytest.raises(ValueError, match="which axis"):
        Contributor("c", "radial", 1e-3, "axis-angle")
    with pytest.raises(ValueError, match="kind direction"):
        Contributor("c", "angle", 1e-3, "reading", "j4")
    with pytest.raises(ValueError, match="no map"):
        Contributor("c", "between-nodes", 1e-3, "axis-angle", "j4")
