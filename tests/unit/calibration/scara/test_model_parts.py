"""Maps, Jacobians and pointing against differences and geometry done by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.calibration.scara.distance_model import distance_model
from catseye.calibration.scara.error_map import BidirectionalMap
from catseye.calibration.scara.errors import MapRangeError
from catseye.calibration.scara.extension import crosstalk, thermal_drift
from catseye.calibration.scara.layout import Layout, ModelName
from catseye.calibration.scara.pointing import (
    aim,
    beam_direction,
    beam_miss,
    column_clearance,
    field_angle,
    nearest_branch,
    visible,
)
from tests.unit.calibration.scara.paper import NODES1_DEG, NODES2_DEG, paper_points, random_truth


def test_map_weights_are_those_of_the_corrected_equation() -> None:
    table = BidirectionalMap(np.array([0.0, 1.0]), np.array([10.0, 20.0]), np.array([-1.0, -2.0]))
    values = table.deviation(np.array([0.25, 0.25, 1.0, 0.0]), np.array([1, -1, 1, -1]))
    assert values == pytest.approx([12.5, -1.25, 20.0, -1.0])


def test_map_is_never_extrapolated() -> None:
    table = BidirectionalMap(np.array([0.0, 1.0]), np.zeros(2), np.zeros(2))
    with pytest.raises(MapRangeError, match="never extrapolated"):
        table.deviation(np.array([1.01]), np.array([1]))


@pytest.mark.parametrize("model", ["conventional", "error-map"])
def test_jacobian_against_central_differences(model: ModelName) -> None:
    points = paper_points(random_truth(1))
    off_node = points.select(np.arange(len(points)) % 7 == 0)
    nodes = (np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)) if model == "error-map" else (np.zeros(0),) * 2
    layout = Layout(model, nodes[0], nodes[1], off_node.reflector_names, off_node.dead_paths)
    shifted = off_node.commands
    inner = (
        np.clip(shifted.theta1_rad + 0.1, nodes[0][0], nodes[0][-1]) if nodes[0].size else shifted.theta1_rad
    )
    object.__setattr__(shifted, "theta1_rad", inner)
    distances = distance_model(layout, off_node)
    places = np.array([[650.0, -400.0], [680.0, 0.0], [640.0, 380.0]])
    at = distances.start(325.0, 225.0, places) + np.random.default_rng(2).normal(0, 1e-4, layout.size)
    jacobian = distances.jacobian(at)
    step = 1e-5
    numeric = np.stack(
        [
            (distances.residuals(at + step * unit) - distances.residuals(at - step * unit)) / (2 * step)
            for unit in np.eye(layout.size)
        ],
        axis=1,
    )
    assert jacobian == pytest.approx(numeric, abs=2e-5)


def test_start_makes_the_mean_residual_of_each_segment_zero() -> None:
    points = paper_points(random_truth(1))
    layout = Layout("conventional", np.zeros(0), np.zeros(0), points.reflector_names, points.dead_paths)
    distances = distance_model(layout, points)
    residuals = distances.residuals(
        distances.start(325.0, 225.0, np.array([[650.0, -400], [680, 0], [640, 380]]))
    )
    assert [residuals[points.dead_path == k].mean() for k in range(3)] == pytest.approx([0.0] * 3, abs=1e-9)


@given(st.floats(-2.4, 1.0), st.floats(0.0, 2.4), st.floats(-0.05, 0.05))
def test_aimed_beam_hits_and_the_tool_turns_with_the_arm(
    theta1: float, theta2: float, theta40: float
) -> None:
    first, second = np.array([theta1]), np.array([theta2])
    place = np.array([680.0, 0.0])
    xy = np.array(
        [
            [
                325 * np.cos(theta1) + 225 * np.cos(theta1 + theta2),
                325 * np.sin(theta1) + 225 * np.sin(theta1 + theta2),
            ]
        ]
    )
    j4 = aim(first, second, beam_direction(xy, place), theta40)
    assert -np.pi < j4[0] <= np.pi
    assert beam_miss(xy, first + second + j4 + theta40, place)[0] < 1e-9
    off = beam_miss(xy, first + second + j4 + theta40 + 1e-3, place)[0]
    assert off == pytest.approx(np.sin(1e-3) * np.hypot(*(place - xy[0])), rel=1e-9)


def test_beam_that_points_away_misses_for_ever() -> None:
    assert beam_miss(np.array([[0.0, 0.0]]), np.array([np.pi]), np.array([500.0, 0.0]))[0] == np.inf


def test_branch_nearest_to_the_present_angle() -> None:
    assert nearest_branch(np.array([-3.0]), 3.5)[0] == pytest.approx(-3.0 + 2 * np.pi)


def test_the_column_blocks_only_beams_passing_through_it() -> None:
    reflector = np.array([680.0, 0.0])
    positions = np.array([[-400.0, 0.0], [300.0, 0.0], [-400.0, 300.0]])
    assert column_clearance(positions, reflector)[:2] == pytest.approx([0.0, 300.0])
    # Distance of the origin from the line through (-400, 300) and (680, 0), by the area rule.
    assert column_clearance(positions, reflector)[2] == pytest.approx(680 * 300 / np.hypot(1080, 300))
    seen = visible(positions, reflector, np.pi, 110.0, np.deg2rad(80.0), (50.0, 2000.0))
    assert seen.tolist() == [False, True, True]


def test_field_and_range() -> None:
    reflector, facing = np.array([680.0, 0.0]), np.pi
    positions = np.array(
        [[680.0 - 100 * np.cos(1.2), 100 * np.sin(1.2)], [680.0 + 100.0, 10.0], [660.0, 0.0]]
    )
    assert field_angle(positions, reflector, facing)[0] == pytest.approx(1.2)
    seen = visible(positions, reflector, facing, 110.0, np.deg2rad(80.0), (50.0, 2000.0))
    assert seen.tolist() == [True, False, False]


@pytest.mark.parametrize("model", ["conventional", "error-map"])
def test_each_parameter_has_a_name_and_a_unit(model: ModelName) -> None:
    nodes = np.deg2rad([0.0, 20.0]) if model == "error-map" else np.zeros(0)
    layout = Layout(model, nodes, nodes, ("P1",), (("P1", 0),), (*crosstalk((1,)), *thermal_drift()))
    parameters = layout.parameters()
    assert len(parameters.names) == len(parameters.units) == layout.size
    angles = {name for name, unit in zip(parameters.names, parameters.units, strict=True) if unit == "rad"}
    assert angles == {name for name in parameters.names if "θ" in name and not name.startswith("ΔL")}
