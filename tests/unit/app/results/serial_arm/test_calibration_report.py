"""The page of a calibrated arm: certificate, figures before and after, masses, correlations, index of a choice."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from catseye.app.cli import cli
from catseye.app.render.page import page_html
from catseye.app.render.text import statement_lines
from catseye.app.results.figures import Bars
from catseye.app.results.model import Report
from catseye.app.results.serial_arm.calibration_report import calibration_report
from catseye.app.results.serial_arm.result import SerialArmResult, read_serial_arm
from tests.unit.app.results.serial_arm.tables import arm_file, poses_file, some_poses, tool_file


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> SerialArmResult:
    folder = tmp_path_factory.mktemp("report")
    words = ["--poses", str(poses_file(folder, some_poses(60))), "--arm", str(arm_file(folder))]
    words += [
        "--tool",
        str(tool_file(folder)),
        "--model",
        "geometric+compliance",
        "-o",
        str(folder / "arm.json"),
    ]
    done = CliRunner().invoke(cli, ["calibrate", *words])
    assert done.exit_code == 0, done.output
    return read_serial_arm(folder / "arm.json")


@pytest.fixture(scope="module")
def report(result: SerialArmResult) -> Report:
    return calibration_report("Calibration", result)


def test_histograms_count_every_row_before_and_after(report: Report, result: SerialArmResult) -> None:
    histograms, places = report.figures("errors")
    counted = [
        int(mark.height.sum())
        for panel in histograms.rows[0]
        if panel is not None
        for mark in panel.marks
        if isinstance(mark, Bars)
    ]
    assert counted == [60, 60]
    assert len(places.rows[0]) == 2
    assert result.errors is not None
    assert len(result.errors.place_mm) == 60


def test_certificate_states_errors_before_and_after(report: Report, result: SerialArmResult) -> None:
    rows = report.table("certificate").rows
    assert result.frames is not None
    assert rows[0][1] == result.frames.mean_mm
    assert rows[1][1] == result.cross_validation.mean_mm


def test_wrong_masses_cost_hundredths_of_a_millimetre(report: Report, result: SerialArmResult) -> None:
    assert result.masses is not None
    assert 0.0 < result.masses.mean_mm < 0.1
    assert "every mass and centre of gravity wrong by 10 %" in " ".join(
        one.text for one in report.statements()
    )


def test_correlations_are_sorted_by_size(report: Report) -> None:
    sizes = [abs(row[2]) for row in report.table("correlations").rows if isinstance(row[2], float)]
    assert len(sizes) == 12
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] <= 1.0


def test_deviations_are_drawn_by_unit(report: Report) -> None:
    assert [figure.key for figure in report.figures("deviations")] == [
        "deviations-mm",
        "deviations-deg",
        "deviations-rad-n-mm",
    ]


def test_page_of_a_choice_shows_the_index(tmp_path: Path) -> None:
    words = ["--arm", str(arm_file(tmp_path)), "--tool", str(tool_file(tmp_path)), "--count", "12"]
    words += ["--candidates", "200", "--starts", "1", "-o", str(tmp_path / "chosen.csv")]
    done = CliRunner().invoke(cli, ["select-poses", *words, "--report", str(tmp_path / "chosen.html")])
    assert done.exit_code == 0, done.output
    assert "Index against the number of poses" in (tmp_path / "chosen.html").read_text("utf-8")


def test_uncertainties_far_beyond_the_residuals_are_named(result: SerialArmResult) -> None:
    # u_mm in µm: a thousandfold.
    fit = result.fit.model_copy(update={"chi2_reduced": 1e-6})
    said = statement_lines(calibration_report("Calibration", result.model_copy(update={"fit": fit})))
    assert any("are 1000 times what the residuals show" in line for line in said)
    assert not any(
        "times what the residuals show" in line for line in statement_lines(calibration_report("", result))
    )


def test_the_verdict_links_to_what_shows_it(report: Report) -> None:
    page = page_html(report)
    verdict = page[page.index('id="verdict"') : page.index('id="accuracy"')]
    for anchor in ("table-accuracy", "figure-errors", "figure-places"):
        assert f'href="#{anchor}"' in verdict
        assert f'id="{anchor}"' in page
