"""The page stands by itself, is well formed, and leaves out what is not there."""

import re
from dataclasses import replace
from xml.etree import ElementTree

import pytest

from catseye.app.protocol.banners import SIMULATION_TEXT
from catseye.app.results.model import Origin
from catseye.app.results.scara.findings import Findings
from tests.unit.app.render.page_reader import Page, read_page
from tests.unit.app.results.scara import sample

FIGURES = [
    "figure-maps",
    "figure-path-y",
    "figure-path-x",
    "figure-trajectories",
    "figure-residual-order",
    "figure-residuals",
    "figure-residual-poses",
    "figure-layout",
]


@pytest.fixture(scope="module")
def whole() -> str:
    return sample.whole_page()


def drawings(html: str) -> list[str]:
    return re.findall(r"<svg .*?</svg>", html, re.DOTALL)


def figures(page: Page) -> list[str]:
    return [value for tag, name, value in page.attributes if tag == "figure" and name == "id"]


def test_the_whole_page_has_every_section_and_figure(whole: str) -> None:
    page = read_page(whole)
    assert whole.startswith("<!DOCTYPE html>")
    assert figures(page) == FIGURES
    assert page.headings == [
        "Verdict",
        "Identified arm",
        "Error maps",
        "Positioning quantities of the joints",
        "Validation path",
        "Quality of the fit",
        "Uncertainty",
        "Layout",
        "Reflectors and dead paths",
        "Reflector search",
        "Plan and incidents",
        "Runs and instruments",
        "Conventions",
        "Configuration",
        "Traceability",
    ]


def test_every_figure_is_scalable_labelled_svg(whole: str) -> None:
    found = drawings(whole)
    assert len(found) == len(FIGURES)
    for text in found:
        root = ElementTree.fromstring(text)
        assert root.tag == "{http://www.w3.org/2000/svg}svg"
        assert root.get("viewBox")
        assert root.get("width") is None
        assert root.get("height") is None
        assert root.get("role") == "img"
        assert root.get("aria-label")


def test_names_are_unique_and_every_reference_stays_inside_the_page(whole: str) -> None:
    page = read_page(whole)
    names = page.all_of("id")
    assert len(names) == len(set(names))
    references = page.all_of("href") + page.all_of("xlink:href")
    references += [f"#{name}" for name in re.findall(r"url\(#([^)]*)\)", whole)]
    assert references
    assert {reference[1:] for reference in references} <= set(names)
    assert all(reference.startswith("#") for reference in references)


def test_nothing_is_loaded_and_nothing_runs(whole: str) -> None:
    page = read_page(whole)
    assert not {"script", "link", "img", "iframe", "object", "image", "metadata"} & set(page.tags)
    assert not page.all_of("src")
    assert not re.search(r"@import|url\((?!#)", whole)
    assert not [name for _, name, _ in page.attributes if name.startswith("on")]
    addresses = {
        value for _, name, value in page.attributes if "http" in value and not name.startswith("xmlns")
    }
    assert not addresses


def test_a_page_of_a_thousand_distances_is_small(whole: str) -> None:
    assert sample.whole().findings.results[0].fit.n_points == 1056
    assert len(whole.encode()) < 500_000


def test_the_same_content_gives_the_same_page(whole: str) -> None:
    assert sample.page(sample.whole()) == whole


def test_simulation_is_said_in_a_banner_and_only_then(whole: str) -> None:
    banner = SIMULATION_TEXT
    assert banner in read_page(whole).text
    assert 'class="simulation"' in whole
    assert not sample.bare(sample.hand_made()).origin.simulated
    real = sample.bare_page()
    assert banner not in read_page(real).text
    assert 'class="simulation"' not in real


def test_a_single_result_report_says_it_was_not_checked() -> None:
    page = read_page(sample.bare_page())
    assert figures(page) == [
        "figure-maps",
        "figure-residual-order",
        "figure-residuals",
        "figure-residual-poses",
        "figure-layout",
    ]
    assert "has not been checked against an independent instrument" in page.text
    assert "truth" not in page.text
    assert "Results were identified from: points.csv." in page.text
    for heading in ("Validation path", "Reflector search", "Plan and incidents", "Configuration"):
        assert heading not in page.headings


def test_report_of_the_conventional_model_alone_has_no_maps() -> None:
    page = read_page(sample.page(sample.bare(sample.results()[0])))
    assert figures(page) == [
        "figure-residual-order",
        "figure-residuals",
        "figure-residual-poses",
        "figure-layout",
    ]
    assert page.row("θ20 / mdeg")[0] == "–"
    assert "Error maps" not in page.headings


def test_result_without_residuals_and_covariance_still_has_its_maps() -> None:
    result = sample.results()[1].model_copy(update={"residuals": None, "covariance": None})
    page = read_page(sample.page(sample.bare(result)))
    assert figures(page) == ["figure-maps"]
    assert len(page.row("node / °")) == 5


def test_report_without_results_says_that_nothing_was_identified() -> None:
    empty = sample.Sheet("Nothing", sample.MADE, Findings())
    page = read_page(sample.page(empty))
    assert "Nothing was identified" in page.text
    assert page.headings == ["Verdict", "Conventions", "Traceability"]
    assert figures(page) == []


def test_run_without_validation_and_without_a_cell_file() -> None:
    sheet = sample.whole().found(validation=None, truth=None).measured(cell=None, searches=())
    page = read_page(sample.page(sheet))
    assert figures(page) == [
        "figure-maps",
        "figure-residual-order",
        "figure-residuals",
        "figure-residual-poses",
        "figure-layout",
    ]
    assert "Configuration" not in page.headings


@pytest.mark.parametrize(
    "name",
    [
        "<script>alert(1)</script>" '"><img src=x onerror=alert(1)>' r"P$\frac{1}{$&amp;",
        "_hidden 反射 🐈",
    ],
)
def test_hostile_names_stay_text_everywhere(name: str) -> None:
    bare = replace(sample.bare(sample.hand_made(name)), title=name, origin=Origin(name, name))
    html = sample.page(bare.measured(incidents=[name], warnings=[name]))
    page = read_page(html)
    assert not {"script", "img"} & set(page.tags)
    assert page.text.count(name) >= 8
    for text in drawings(html):
        ElementTree.fromstring(text)


def test_configuration_is_shown_key_by_key(whole: str) -> None:
    text = read_page(whole).text
    assert "robot.link1_mm = 325.0" in text
    assert "reflector[2].name = P2" in text
    assert "robot.limits_deg.j1 = [-170.0, 170.0]" in text


def test_search_runs_devices_and_air_are_shown_with_units(whole: str) -> None:
    page = read_page(whole)
    search = next(row for row in page.rows if row[:2] == ["P1", "651.23"])
    assert search[1:] == ["651.23", "0.42", "−401.57", "0.36", "0.30"]
    assert "θ40 = 0.3422° (U = 0.0224°, k = 2)" in page.text
    assert page.row("robot") == ["RH-3FRH5515", "S7", "EMULATOR-1", "tcp://127.0.0.1:10001", "EMULATED"]
    assert page.row("temperature / °C") == ["20.11", "20.23", "20.41"]
    assert page.row("20260102T030405Z_open-loop_ab12cd")[-3:] == ["1 h 23 min", "1056", "0"]
    assert "12 commands are blind" in page.text
    assert "beam lost" in page.text
