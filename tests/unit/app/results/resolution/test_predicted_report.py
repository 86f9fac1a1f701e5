"""Predictions and joint models beside measured tests: Table 6 and Figures 9 to 11 of the resolution paper."""

import json
from pathlib import Path

import numpy as np
import pytest

from catseye.app.errors import UsageError
from catseye.app.results.figures import Band, Figure, Level, Line, Panel, Points
from catseye.app.results.model import Report, Sign
from catseye.app.results.resolution.joint_tables import write_joint_tables
from catseye.app.results.resolution.predicted import read_predicted, write_predicted
from catseye.app.results.resolution.result import write_resolution
from catseye.app.results.resolution.result_report import resolution_files_report
from tests.unit.app.results.resolution.sample import sample_prediction, sample_result, sample_tables


@pytest.fixture
def result(tmp_path: Path) -> Path:
    write_resolution(sample_result(), tmp_path / "result.json")
    return tmp_path / "result.json"


@pytest.fixture
def prediction(tmp_path: Path) -> Path:
    write_predicted(sample_prediction(), tmp_path / "predicted.json")
    return tmp_path / "predicted.json"


@pytest.fixture
def tables(tmp_path: Path) -> Path:
    write_joint_tables(sample_tables(), tmp_path / "tables.csv", simulated=False)
    return tmp_path / "tables.csv"


@pytest.fixture
def report(result: Path, prediction: Path, tables: Path) -> Report:
    return resolution_files_report([tables, prediction, result])


def panels(figure: Figure) -> dict[str, Panel]:
    return {panel.title: panel for row in figure.rows for panel in row if panel is not None}


def named(figures: list[Figure], key: str) -> Figure:
    return next(figure for figure in figures if figure.key == key)


def test_predictions_come_back_as_they_were(prediction: Path) -> None:
    assert read_predicted(prediction) == sample_prediction()


def test_predicted_and_measured_steps_stand_side_by_side(report: Report) -> None:
    rows = {row[:2]: row[2:] for row in report.table("comparison").rows}
    assert rows["P1", "+X"] == ("0.0090 (0.0060 … 0.0120)", "0.020 (0.016 … 0.026)", "no")
    assert rows["P1", "−X"] == ("–", "0.020 (0.016 … 0.026)", "–")
    assert rows["P1", "+Y"] == ("0.018 (0.012 … 0.025)", "0.020 (0.016 … 0.026)", "yes")
    assert rows["P2", "+X"] == ("–", "–", "–")


def test_the_share_inside_the_intervals_is_said(report: Report) -> None:
    said = next(one for one in report.statements() if "within the predicted" in one.text)
    assert (said.sign, said.text.partition(" measured")[0]) == (Sign.ATTENTION, "4 of 5")


def test_least_steps_stand_beside_their_direction(report: Report) -> None:
    panel = panels(named(report.figures("cartesian"), "cartesian-steps"))["P1"]
    assert panel.x.names == ("+X", "−X", "+Y", "−Y", "+Z", "−Z")
    points = {mark.label: mark for mark in panel.marks if isinstance(mark, Points) and mark.label}
    # Of −X nothing is predicted.
    assert np.round(points["predicted"].x).tolist() == [0, 2, 3, 4, 5]
    assert np.round(points["measured"].x).tolist() == [0, 1, 2, 3, 4, 5]
    assert 10.0 ** points["predicted"].y[0] == pytest.approx(0.009)


def test_predicted_errors_lie_below_measured_ones(report: Report) -> None:
    drawn = panels(named(report.figures("cartesian"), "predicted-P1"))
    assert list(drawn) == ["+X", "+Y", "+Z", "−Y", "−Z"]
    line = next(mark for mark in drawn["+X"].marks if isinstance(mark, Line))
    band = next(mark for mark in drawn["+X"].marks if isinstance(mark, Band))
    assert (line.y[0], band.low[0], band.high[0]) == (1.0, -1.0, 3.0)
    upright = [mark.at for mark in drawn["+X"].marks if isinstance(mark, Level) and mark.vertical]
    assert upright == pytest.approx([np.log10(0.009), np.log10(0.02)])


def test_models_are_drawn_at_tested_positions(report: Report) -> None:
    (figure,) = report.figures("models")
    drawn = panels(figure)
    assert list(drawn) == ["K1 = −175°", "K2 = −90°", "K3 = 0°", "K4 = 90°", "K5 = 175°"]
    band = next(mark for mark in drawn["K3 = 0°"].marks if isinstance(mark, Band))
    assert (band.low[0], band.high[0]) == pytest.approx((-7.0, 1.0))


def test_a_prediction_of_emulated_devices_marks_the_page(tmp_path: Path, prediction: Path) -> None:
    result = sample_result()
    assert result.provenance is not None
    measured = result.provenance.model_copy(update={"simulated": False})
    own = tmp_path / "own.json"
    write_resolution(result.model_copy(update={"provenance": measured}), own)
    assert not resolution_files_report([own, prediction]).origin.simulated
    write_predicted(sample_prediction().model_copy(update={"simulated": True}), prediction)
    assert resolution_files_report([own, prediction]).origin.simulated


def test_a_prediction_alone_is_refused(prediction: Path) -> None:
    with pytest.raises(UsageError, match="name a result of catseye resolution, too"):
        resolution_files_report([prediction])


def test_a_prediction_of_another_arm_is_refused(result: Path, prediction: Path) -> None:
    write_predicted(sample_prediction().model_copy(update={"arm": "IRB 120"}), prediction)
    with pytest.raises(UsageError, match="of several arms: KR 210 R2700, IRB 120"):
        resolution_files_report([result, prediction])


def test_two_sets_of_tables_are_refused(tmp_path: Path, result: Path, tables: Path) -> None:
    other = tmp_path / "other.csv"
    other.write_bytes(tables.read_bytes())
    with pytest.raises(UsageError, match="a report shows one set of tables"):
        resolution_files_report([result, tables, other])


@pytest.mark.parametrize(("name", "values"), [("std_percent", [1.0]), ("command", [])])
def test_columns_of_another_length_are_refused(tmp_path: Path, name: str, values: list[float]) -> None:
    document = json.loads(sample_prediction().model_dump_json())
    document["least_steps"][0]["curve"][name] = values
    path = tmp_path / "edited.json"
    path.write_text(json.dumps(document), "utf-8")
    with pytest.raises(UsageError, match=r"edited\.json: .*the columns differ in length"):
        read_predicted(path)


def test_a_step_of_no_size_is_refused(tmp_path: Path) -> None:
    document = json.loads(sample_prediction().model_dump_json())
    document["least_steps"][0]["curve"]["command"][0] = 0.0
    path = tmp_path / "edited.json"
    path.write_text(json.dumps(document), "utf-8")
    with pytest.raises(UsageError, match=r"edited\.json: .*curve\.command\.0: .*greater than 0"):
        read_predicted(path)
