"""How a path is looked at, and the panels drawn from it."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.lines import Line2D

from app.analysis.validation import validate_on_path
from app.report.figures.canvas import svg
from app.report.figures.path_deviation import path_figure
from app.report.figures.path_vectors import MAGNIFICATION, vector_figure
from app.report.page import render_html
from app.report.path_view import gaps, path_axis
from calibration.types import Floats
from tests.unit.app.report import sample
from tests.unit.app.report.page_reader import read_page


def drawn_points(line: Line2D) -> Floats:
    return np.asarray(line.get_xydata(), dtype=np.float64)


@pytest.mark.parametrize(
    ("along", "label", "symbols", "components"),
    [
        ("y", "Y / mm", ["E_{YY}", "E_{XY}"], [1, 0]),
        ("x", "X / mm", ["E_{XX}", "E_{YX}"], [0, 1]),
        ("diagonal", "way along the path / mm", ["E_X", "E_Y"], [0, 1]),
    ],
)
def test_axis_follows_the_path(along: str, label: str, symbols: list[str], components: list[int]) -> None:
    axis = path_axis(sample.path(along))
    assert axis.label == label
    assert [symbol for symbol, _, _ in axis.deviations] == symbols
    assert [component for _, _, component in axis.deviations] == components


def test_gaps_cover_the_rows_left_out_and_name_the_joint() -> None:
    validation = sample.validation()
    (gap,) = gaps(validation, sample.results()[1])
    assert gap.reason == "θ2 beyond the nodes: not predicted"
    y = validation.path.command_mm[:, 1]
    inside = (y > gap.low_mm) & (y < gap.high_mm)
    np.testing.assert_array_equal(inside, ~validation.compared)
    assert gaps(validation, None)[0].reason == "not predicted"


def test_a_path_inside_the_nodes_has_no_gap() -> None:
    validation = sample.validation("x")
    assert validation.compared.all()
    assert gaps(validation, sample.results()[1]) == []


def test_panels_show_measured_minus_command_in_micrometres_for_each_direction() -> None:
    validation = sample.validation()
    figure = path_figure(validation)
    upper_right, lower_right = figure.axes[1], figure.axes[3]
    there = validation.path.travel > 0
    error_um = 1e3 * validation.models[1].comparison.measured_error_mm
    for axes, component in ((upper_right, 1), (lower_right, 0)):
        line = next(one for one in axes.lines if one.get_label() == "measured, way there")
        expected = np.column_stack([validation.path.command_mm[there, 1], error_um[there, component]])
        np.testing.assert_allclose(drawn_points(line), expected)


def test_vectors_are_magnified_a_thousand_times_and_end_with_the_difference() -> None:
    validation = sample.validation()
    figure = vector_figure(validation)
    assert [axes.get_title("left") for axes in figure.axes] == [
        "a) measured",
        "b) error map",
        "c) conventional model",
        "d) = a − b",
    ]
    assert MAGNIFICATION == 1000
    there = validation.path.travel > 0
    ends = next(one for one in figure.axes[0].lines if str(one.get_label()).startswith("way there"))
    expected = validation.path.command_mm + 1000.0 * validation.models[1].comparison.measured_error_mm
    np.testing.assert_allclose(drawn_points(ends), expected[there])


def test_the_measurement_looks_different_to_each_direction_without_colour() -> None:
    drawn = path_figure(sample.validation())
    markers = {line.get_marker() for line in drawn.axes[1].lines if line.get_marker() not in {"None", ""}}
    assert {"x", "+", "o", "s"} <= markers


@pytest.mark.parametrize("along", ["x", "diagonal"])
def test_other_paths_and_a_single_model_make_a_page(along: str) -> None:
    alone = validate_on_path(sample.path(along), [sample.measurement()[1][1].arm], (325.0, 225.0))
    page = read_page(render_html(replace(sample.whole(), validation=alone)))
    assert page.all_of("id").count("figure-path") == 1
    assert "b) = a − b" not in page.text
    assert "c) = a − b" in page.text


def test_labels_of_the_figures_stay_text() -> None:
    text = svg(vector_figure(sample.validation()), "name", 'a "label"')
    assert "way there, error × 1000" in text
    assert 'aria-label="a &quot;label&quot;"' in text
