"""How a path is looked at, and the panels dense_figure from it."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.lines import Line2D

from catseye.app.render.canvas import svg
from catseye.app.render.mpl import drawn
from catseye.app.results.scara.figures.path import path_figures
from catseye.app.results.scara.figures.trajectories import magnification, trajectory_figure
from catseye.app.results.scara.path_view import gaps, path_axis
from catseye.app.results.scara.validation import ModelOnPath, validate_on_path
from catseye.calibration.core.types import Floats
from tests.unit.app.render.page_reader import read_page
from tests.unit.app.results.scara import sample


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
    along, across = (drawn(figure).axes for figure in path_figures(validation))
    there = validation.path.travel > 0
    y = validation.path.command_mm[there, 1]
    comparison = validation.models[1].comparison
    # Right column: E_YY, what is left of it; E_XY, what is left of it.
    for panel, error_mm in (
        (along[1], comparison.measured_error_mm[:, 1]),
        (along[3], comparison.difference_mm[:, 1]),
        (across[1], comparison.measured_error_mm[:, 0]),
        (across[3], comparison.difference_mm[:, 0]),
    ):
        line = next(one for one in panel.lines if one.get_marker() == "x")
        np.testing.assert_allclose(drawn_points(line), np.column_stack([y, 1e3 * error_mm[there]]))


def test_many_rows_become_a_line_with_a_band() -> None:
    path = sample.path()
    sparse = drawn(path_figures(sample.validation())[0])
    rows = np.repeat(np.arange(82), 3)
    commands = path.commands.select(rows)
    dense = replace(
        path,
        commands=commands,
        command_mm=path.command_mm[rows],
        travel=path.travel[rows],
        measured_mm=path.measured_mm[rows],
        u_mm=path.u_mm[rows],
        established=path.established[rows],
    )
    arms = [one.arm for one in sample.measurement()[1]]
    dense_figure = drawn(path_figures(validate_on_path(dense, arms, (325.0, 225.0)))[0])
    assert [len(figure.axes[1].containers) for figure in (sparse, dense_figure)] == [2, 0]
    assert "error map, way there" in {one.get_label() for one in dense_figure.axes[1].lines}


def test_trajectories_are_magnified_and_end_with_the_difference() -> None:
    validation = sample.validation()
    figure = drawn(trajectory_figure(validation))
    assert [axes.get_title("left") for axes in figure.axes] == [
        "a) measured",
        "b) error map",
        "c) conventional model",
        "d) = a − b",
    ]
    assert magnification(validation) == 1000.0
    there = validation.path.travel > 0
    ends = next(one for one in figure.axes[0].lines if str(one.get_label()).startswith("way there"))
    expected = validation.path.command_mm + 1000.0 * validation.models[1].comparison.measured_error_mm
    np.testing.assert_allclose(drawn_points(ends), expected[there])


@pytest.mark.parametrize(("share", "expected"), [(1.0, 1000.0), (100.0, 10.0), (0.01, 50_000.0)])
def test_errors_are_magnified_so_that_they_can_be_seen(share: float, expected: float) -> None:
    # The path is 1 m long, its largest error about 0.15 mm: it is drawn between 4 % and 35 % of the path.
    validation = sample.validation()

    def grown(model: ModelOnPath) -> ModelOnPath:
        comparison, prediction = model.comparison, model.prediction
        command = prediction.command_mm
        return replace(
            model,
            comparison=replace(
                comparison,
                measured_error_mm=share * comparison.measured_error_mm,
                difference_mm=share * comparison.difference_mm,
            ),
            prediction=replace(prediction, position_mm=command + share * (prediction.position_mm - command)),
        )

    changed = replace(validation, models=tuple(grown(model) for model in validation.models))
    factor = magnification(changed)
    largest = share * float(np.nanmax(np.hypot(*validation.models[1].comparison.measured_error_mm.T)))
    assert 0.04 * 1000.0 <= factor * largest <= 0.35 * 1000.0
    assert expected / 5.0 <= factor <= 5.0 * expected


def test_the_scale_bar_matches_the_error_it_names() -> None:
    validation = sample.validation()
    axes = drawn(trajectory_figure(validation)).axes[0]
    bar = next(line for line in axes.lines if line.get_linewidth() == 2.0)
    (text,) = (one.get_text() for one in axes.texts)
    length = float(np.ptp(drawn_points(bar)[:, 0]))
    assert text == f"error {1e3 * length / magnification(validation):g} µm"


def test_the_measurement_looks_different_to_each_direction_without_colour() -> None:
    dense_figure = drawn(path_figures(sample.validation())[0])
    markers = {
        line.get_marker() for line in dense_figure.axes[1].lines if line.get_marker() not in {"None", ""}
    }
    assert {"x", "+", "o", "s"} <= markers


@pytest.mark.parametrize("along", ["x", "diagonal"])
def test_other_paths_and_a_single_model_make_a_page(along: str) -> None:
    alone = validate_on_path(sample.path(along), [sample.measurement()[1][1].arm], (325.0, 225.0))
    results = [one.model_copy(update={"residuals": None}) for one in sample.results()]
    page = read_page(sample.page(sample.whole().found(results=results, validation=alone)))
    assert page.all_of("id").count("figure-path-y") == 1
    assert "b) = a − b" not in page.text
    assert "c) = a − b" in page.text


def test_labels_of_the_figures_stay_text() -> None:
    text = svg(drawn(trajectory_figure(sample.validation())), "name", 'a "label"')
    assert "way there, error × 1000" in text
    assert 'aria-label="a &quot;label&quot;"' in text
