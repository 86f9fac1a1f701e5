"""Small parts: markup, numbers, groups of residuals, the scene of the layout."""

import math

import numpy as np
import pytest

from catseye.app.render.markup import Html, element, join, section, table, unbroken
from catseye.app.render.mpl import drawn
from catseye.app.results.scara.figures.layout import layout_figure
from catseye.app.results.scara.figures.residuals import residual_figure
from catseye.app.results.scara.findings import Findings
from catseye.app.results.scara.layout import Scene, scene_of
from catseye.app.results.scara.residuals import pose_means, reference
from tests.unit.app.results.scara import sample


def scene_shown(findings: Findings) -> Scene | None:
    path_mm = None if findings.validation is None else findings.validation.path.command_mm
    return scene_of(findings.bench, findings.best, path_mm)


def test_text_is_escaped_once_and_markup_stands() -> None:
    assert element("p", "<&", class_='"') == '<p class="&quot;">&lt;&amp;</p>'
    assert join([Html("<b>x</b>"), "<"]) == "<b>x</b>&lt;"
    assert isinstance(join(["a"]), Html)


def test_section_without_content_vanishes() -> None:
    assert section("a", "Title", "", "") == ""
    assert section("a", "Title", "x") == '<section id="a"><h2>Title</h2>x</section>'


def test_table_marks_head_names_and_numbers() -> None:
    text = table(["name", "value"], [["a<b", "1"]], [False, True], labelled_by="what")
    assert '<th scope="row" class="text">a&lt;b</th><td class="number">1</td>' in text
    assert text.startswith('<table aria-labelledby="what"><thead>')


def test_numbers_keep_their_units() -> None:
    assert unbroken("2.6 µm and 98 %, 3 rows") == "2.6\u00a0µm and 98\u00a0%, 3 rows"


def test_means_per_pose_average_the_repeats() -> None:
    residuals = sample.hand_made().residuals
    assert residuals is not None
    means = pose_means(residuals, "P1")
    first = (means.theta1_deg == -20.0) & (means.theta2_deg == -20.0)
    assert means.mean_um[first].tolist() == [-1.5]
    assert means.count[first].tolist() == [2.0]
    assert means.count.sum() == 8.0


def test_reference_is_what_was_stated_or_else_the_fit_itself() -> None:
    assert reference(sample.fit()).sigma_um == pytest.approx(15.6, abs=1e-3)
    assert reference(sample.fit()).stated
    unstated = reference(sample.fit(chi2=None))
    assert (unstated.sigma_um, unstated.stated) == (15.7652, False)
    assert reference(sample.fit(sample.LACK)).scatter_um == 9.87


def test_reflectors_differ_by_marker_not_only_by_colour() -> None:
    residuals = sample.results()[1].residuals
    assert residuals is not None
    figure = drawn(residual_figure(residuals, reference(sample.fit()), "error map"))
    lines = [line for line in figure.axes[0].lines if str(line.get_label()).startswith("reflector")]
    assert len({line.get_marker() for line in lines}) == 3


def test_one_distance_makes_a_figure() -> None:
    residuals = sample.hand_made().residuals
    assert residuals is not None
    one = residuals.model_copy(update={name: values[:1] for name, values in residuals.model_dump().items()})
    assert drawn(residual_figure(one, reference(sample.fit()), "error map")).axes


def test_scene_of_a_bench_knows_what_is_blind() -> None:
    scene = scene_shown(sample.whole().findings)
    assert scene is not None
    assert scene.commands_mm.shape == (88, 2)
    assert [target.name for target in scene.targets] == ["P1", "P2", "P3"]
    assert scene.path_mm is not None
    blind = [len(target.blind_mm) for target in scene.targets]
    assert 0 < sum(blind) < 10
    labels = drawn(layout_figure(scene)).axes[0].get_legend_handles_labels()[1]
    assert {"base column", "validation path", "reach of the arm", "arm at one pose", "laser beam"} <= set(
        labels
    )
    assert sum(label.startswith("blind for") for label in labels) == sum(count > 0 for count in blind)


def test_scene_of_a_result_alone_has_neither_fields_nor_column() -> None:
    scene = scene_shown(sample.bare(sample.hand_made()).findings)
    assert scene is not None
    assert scene.column_radius_mm is None
    assert scene.targets[0].facing_deg is None
    np.testing.assert_allclose(scene.targets[0].xy_mm, [651.23456, -401.5])
    assert scene_shown(Findings()) is None


def test_truth_between_its_nodes_is_interpolated_and_never_extrapolated() -> None:
    truth = sample.truth_tables().theta2_map
    middle = truth.at([10.0, -5.0], 1)
    assert middle[0] == pytest.approx(0.5 * (truth.positive_mdeg[0] + truth.positive_mdeg[1]))
    assert math.isnan(middle[1])
