"""Reports of results of motion resolution."""

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from catseye.app.errors import UsageError
from catseye.app.render.page import page_html
from catseye.app.results.figures import Level, Line, Points
from catseye.app.results.model import Entries, Report, Sign, Statement
from catseye.app.results.resolution.certificate import certificate
from catseye.app.results.resolution.figures.least_steps import least_step_figure
from catseye.app.results.resolution.figures.staircase import staircase_figure
from catseye.app.results.resolution.figures.step_errors import step_error_figure
from catseye.app.results.resolution.result import AnyTest, MeasuredRun, Reversal, write_resolution
from catseye.app.results.resolution.result_report import resolution_files_report
from catseye.app.results.resolution.tables_of_tests import least_step_table, reversal_table
from catseye.app.results.resolution.verdict import verdict
from catseye.app.results.runs.records import Sources
from tests.unit.app.results.resolution.sample import sample_result


def told(tests: Sequence[AnyTest], refused: Sequence[str] = ()) -> list[Statement]:
    """Return the verdict without the links of its statements."""
    return [replace(one, see=()) for one in verdict(tests, refused) if isinstance(one, Statement)]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "result.json"
    write_resolution(sample_result(), path)
    return path


@pytest.fixture
def report(file: Path) -> Report:
    return resolution_files_report([file])


def test_ideal_least_steps_are_those_of_the_paper(report: Report) -> None:
    """Table 4 of the paper: 5.3e-6° for joint 1, 6.5e-6° for joint 5."""
    rows = report.table("actuation").rows
    assert [(row[0], round(float(str(row[3])), 1)) for row in rows] == [("A1", 5.3), ("A5", 6.5)]


def test_least_steps_stand_by_joint_and_position(report: Report) -> None:
    rows = report.table("least-steps").rows
    assert [row[:2] for row in rows[:2]] == [("A1", "K1 = −175°"), ("A1", "K2 = −90°")]
    assert rows[0][3:] == (
        "0.0030° (0.0024° … 0.0045°)",
        "0.00015° (0.00013° … 0.00019°)",
        "0.00015° (0.00013° … 0.00019°)",
    )
    assert len(rows) == 8


def test_the_rule_on_a_series_stands_beside_its_least_step() -> None:
    tests = [one for one in sample_result().tests if one.joint == "A1" and one.position == 0.0]
    tests = [
        one.model_copy(update={"by_rule": 1.2e-4} if one.direction == 1 else {}) for one in tests if one.lis
    ]
    table = least_step_table(tests, [])
    assert table is not None
    assert table.rows[0][-1] == "0.00012°, –"
    (said,) = [one.text for one in verdict(tests) if isinstance(one, Statement) and "A1 at 0°, +" in one.text]
    assert said.endswith("least step 0.00015° (0.00013° … 0.00019°); by the rule on this series 0.00012°")


def test_a_reversal_without_a_change_of_sign_is_not_valid(report: Report) -> None:
    rows = {(row[0], row[1]): row[4] for row in report.table("reversal").rows}
    assert rows["A5", "−110°"] == "yes: valid"
    assert rows["A5", "110°"] == "no: not valid"
    signs = {one.text.partition(":")[0]: one.sign for one in report.statements() if "reversal" in one.text}
    assert (signs["A5 at −110°"], signs["A5 at 110°"]) == (Sign.NEUTRAL, Sign.ATTENTION)


def test_what_speaks_against_a_test_stands_in_the_verdict() -> None:
    (test,) = [one for one in sample_result().tests if one.joint == "A1" and one.lis][:1]
    doubtful = test.model_copy(update={"doubts": ["a glitch", "a gap"]})
    least, doubt = told([doubtful])
    assert least == Statement(Sign.NEUTRAL, "A1 at −175°, +: least step 0.00015° (0.00013° … 0.00019°)")
    assert doubt == Statement(Sign.ATTENTION, "A1 at −175°, +: a glitch; a gap")


def test_of_many_doubtful_tests_the_verdict_names_the_places() -> None:
    tests = [one for one in sample_result().tests if one.joint == "A1" and one.test == "decaying"]
    said = told([one.model_copy(update={"doubts": ["a glitch"]}) for one in tests])
    (doubt,) = [one.text for one in said if one.sign is Sign.ATTENTION]
    assert doubt.startswith(
        "10 tests with something that speaks against them, see “What was noticed”: A1 at −175°, +,"
    )


def test_a_direction_without_a_least_step_says_why(report: Report) -> None:
    expected = "+X at P2: no least step can be stated: no step kept within the threshold"
    assert (Sign.ATTENTION, expected) in [(one.sign, one.text) for one in report.statements()]
    assert report.table("cartesian").rows[0] == ("+X", "0.020 mm (0.016 mm … 0.026 mm)", "–")


def test_methods_are_compared_by_their_own_durations(report: Report) -> None:
    rows = {row[0]: row[1:] for row in report.table("methods").rows}
    assert rows["duration of a test"] == ("2 min 35 s", "9 min 05 s")
    assert rows["step sizes a test"] == ("1", "109")


def test_the_certificate_states_the_worst_of_each_joint(report: Report) -> None:
    rows = {row[0]: row[1:] for row in report.table("certificate").rows}
    assert rows["A1"] == ("20", "0.00015° (0.00013° … 0.00019°)", "0.0030° (0.0024° … 0.0045°)", "0.0060°")
    # Of A5 only the reversal error at −110° is valid.
    assert rows["A5"][3] == "0.0047°"


def test_many_tests_of_a_joint_are_said_together(report: Report) -> None:
    said = [one.text for one in report.statements() if one.text.startswith("A1")]
    assert said == [
        "A1, 10 tests: least steps from 0.00015° (0.00013° … 0.00019°), A1 at −175°, +, to 0.00015° (0.00013° … "
        "0.00019°), A1 at 175°, −",
        "A1, ISO 230, 5 tests: least steps from 0.0030° (0.0024° … 0.0045°), A1 at −175°, to 0.0030° (0.0024° … "
        "0.0045°), A1 at 175°",
        "A1: reversal errors 0.0040° … 0.0060° (U = 0.000040° or less, k = 2) at 5 positions, where the torque "
        "changes its sign: they are lost motion",
    ]


@pytest.mark.parametrize(
    ("value", "sign", "said"),
    [
        (
            0.005,
            Sign.NEUTRAL,
            "0.0050° (U = 0.000094°, k = 2); the torque changes its sign: it is lost motion",
        ),
        (0.00009, Sign.NEUTRAL, "0.000090° (U = 0.000094°, k = 2): not distinguishable from none"),
        (-0.000023, Sign.NEUTRAL, "−0.000023° (U = 0.000094°, k = 2): not distinguishable from none"),
        (
            -0.005,
            Sign.ATTENTION,
            "−0.0050° (U = 0.000094°, k = 2): the joint went too far, which is not lost motion",
        ),
    ],
)
def test_a_reversal_error_is_said_with_its_uncertainty(value: float, sign: Sign, said: str) -> None:
    found = Reversal(value=value, u=4.7e-5, valid=True)
    (test,) = [one for one in sample_result().tests if one.test == "backlash" and one.position == 0.0][:1]
    assert told([test.model_copy(update={"reversal": found})]) == [
        Statement(sign, f"A1 at 0°: reversal error {said}")
    ]


def test_a_torque_by_another_clock_is_not_called_missing() -> None:
    (test,) = [one for one in sample_result().tests if one.test == "backlash" and one.position == 0.0][:1]
    assert test.torque is not None
    test = test.model_copy(update={"reversal": Reversal(value=0.005, u=4.7e-5, valid=None)})
    (said,) = (block.text for block in verdict([test]) if isinstance(block, Statement))
    assert said.endswith("the torque is by another clock: it says nothing certain about play")
    table = reversal_table([test])
    assert table is not None
    assert "torque by another clock: not valid" in table.rows[0]


def test_a_reversal_error_without_u_says_so() -> None:
    (test,) = [one for one in sample_result().tests if one.test == "backlash" and one.position == 0.0][:1]
    test = test.model_copy(update={"reversal": Reversal(value=0.005, u=None, valid=None), "torque": None})
    (said,) = (block.text for block in verdict([test]) if isinstance(block, Statement))
    assert said.startswith("A1 at 0°: reversal error 0.0050° (U not known); no torque was recorded")
    table = reversal_table([test])
    assert table is not None
    assert table.rows[0][2:4] == ("0.0050°", "–")


def test_reversal_errors_that_may_be_none_are_said_apart() -> None:
    tests = [one for one in sample_result().tests if one.test == "backlash" and one.joint == "A1"]
    tests[2] = tests[2].model_copy(update={"reversal": Reversal(value=1e-5, u=4.7e-5, valid=True)})
    many, one = (block.text for block in verdict(tests) if isinstance(block, Statement))
    assert "at 4 positions" in many
    assert one == "A1 at 0°: reversal error 0.000010° (U = 0.000094°, k = 2): not distinguishable from none"


def test_the_certificate_names_who_measured_with_what() -> None:
    run = MeasuredRun(
        run="resolution-1",
        started_utc="2026-01-02T03:04:05+00:00",
        operator="M. Tester",
        devices=["interferometer XL-80 4.2 no. 7YK301"],
        optics=["angular, spacing 30 mm, u = 0.01 mm (k = 1)"],
    )
    result = sample_result().model_copy(update={"measured": [run, run]})
    page = certificate([result], result.tests, [], Sources({}, {"a.json": "0123456789abcdef" * 4}))
    entries = next(dict(block.entries) for block in page.blocks if isinstance(block, Entries))
    assert entries["measured on"] == "2026-01-02"
    assert entries["operator"] == "M. Tester"
    assert entries["instruments"] == "interferometer XL-80 4.2 no. 7YK301"
    assert entries["optics"] == "angular, spacing 30 mm, u = 0.01 mm (k = 1)"
    assert entries["files"] == "a.json (SHA-256 0123456789abcdef…)"


def test_a_least_step_open_downwards_is_drawn() -> None:
    tests = [test for test in sample_result().tests if test.joint == "A5"]
    open_below = [
        test.model_copy(update={"lis": test.lis.model_copy(update={"low": 0.0})}) if test.lis else test
        for test in tests
    ]
    figure = least_step_figure("A5", open_below)
    assert figure is not None
    panel = figure.rows[0][0]
    assert panel is not None
    labels = {mark.label: mark.x.size for mark in panel.marks if isinstance(mark, Points) and mark.label}
    assert labels["least step, positive"] == 3
    assert (panel.y.low, panel.y.high) == (-3.0, -1.0)


def test_a_report_of_emulated_devices_says_so(report: Report) -> None:
    assert report.origin.simulated


def test_results_of_several_arms_are_not_mixed(file: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.json"
    write_resolution(sample_result().model_copy(update={"arm": "IRB 120"}), other)
    with pytest.raises(UsageError, match="of several arms: KR 210 R2700, IRB 120; make a report of each"):
        resolution_files_report([file, other])


def test_results_of_one_arm_are_shown_together(file: Path) -> None:
    report = resolution_files_report([file, file])
    assert report.title == "Motion resolution of KR 210 R2700"
    assert [row[1] for row in report.table("certificate").rows[:2]] == ["40", "24"]


def test_shipped_tests_are_marked(file: Path) -> None:
    document = json.loads(file.read_text("utf-8"))
    document["tests"][0]["shipped"] = True
    file.write_text(json.dumps(document), "utf-8")
    report = resolution_files_report([file])
    assert report.table("least-steps").rows[0][4] == "0.00015° (0.00013° … 0.00019°) ✱"
    assert "✱" not in str(report.table("least-steps").rows[1])
    (found,) = report.section("certificate").blocks[:1]
    assert isinstance(found, Entries)
    assert dict(found.entries)["tests"] == "39, 1 of them shipped with the program and not of this arm"
    first = report.figures("errors")[0].rows[0]
    assert [panel.title for panel in first if panel] == ["K1 = −175° ✱", "K2 = −90°", "K3 = 0°"]
    last = report.statements()[-1]
    assert last.sign is Sign.ATTENTION
    assert last.text.endswith("say nothing about this arm: A1 at −175°")


def test_plateaus_are_drawn_where_they_are() -> None:
    test = next(test for test in sample_result().tests if test.test == "iso")
    figure = staircase_figure(test)
    assert figure is not None
    panel = figure.rows[0][0]
    assert panel is not None
    plateaus = panel.marks[1]
    assert isinstance(plateaus, Line)
    assert plateaus.x[:2].tolist() == pytest.approx([2.7, 4.7])
    assert np.isnan(plateaus.y[2::3]).all()


def test_a_least_step_stands_upright_at_its_logarithm() -> None:
    figure = step_error_figure("A1", sample_result().tests)
    assert figure is not None
    panel = figure.rows[0][0]
    assert panel is not None
    assert panel.x.decades
    assert [mark.at for mark in panel.marks if isinstance(mark, Level) and mark.vertical] == pytest.approx(
        [np.log10(1.5e-4)] * 2
    )


def test_a_joint_at_one_position_has_no_figure_over_positions() -> None:
    tests = [test for test in sample_result().tests if test.joint == "A1" and test.position == 0.0]
    assert least_step_figure("A1", tests) is None


def test_the_verdict_links_to_what_shows_it(report: Report) -> None:
    page = page_html(report)
    anchors = set(re.findall(r'id="((?:table|figure)-[^"]+)"', page))
    said = [one for one in report.statements() if one.see]
    kinds = {key.partition("-")[2].partition("-A")[0] for one in said for key in one.see}
    assert {"least-steps", "errors", "reversal"} <= kinds
    assert all(anchors & set(one.see) for one in said)
    verdict_html = page[page.index('id="verdict"') : page.index('id="least-steps"')]
    assert 'href="#table-least-steps"' in verdict_html
    assert 'href="#figure-errors-A1"' in verdict_html
