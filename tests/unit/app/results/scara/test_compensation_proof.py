"""A path driven with corrected commands: measured and predicted errors are those against the wished positions."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from matplotlib.lines import Line2D

from catseye.app.errors import UsageError
from catseye.app.render.mpl import drawn
from catseye.app.results.model import Sign, Table
from catseye.app.results.scara.compensation_proof import gain_blocks, gain_figure, gain_statement, gains
from catseye.app.results.scara.figures.path import path_figures
from catseye.app.results.scara.figures.trajectories import trajectory_figure
from catseye.app.results.scara.measured import measured_path
from catseye.app.results.scara.path_view import path_axis, shown_errors
from catseye.app.results.scara.validation import PathValidation, validate_on_path
from catseye.app.results.scara.validation_report import line_table
from catseye.calibration.core.types import Floats
from tests.unit.app.cli.arms import text_file
from tests.unit.app.results.scara import sample

NOMINAL = (325.0, 225.0)


@cache
def corrected() -> PathValidation:
    return validate_on_path(sample.corrected_path(), [one.arm for one in sample.measurement()[1]], NOMINAL)


def aligned(place: Floats, wished: Floats) -> Floats:
    """Return places minus wished ones after the best rotation and shift, found with complex numbers."""
    a, b = place @ [1.0, 1j], wished @ [1.0, 1j]
    sum_ab = np.sum((b - b.mean()) * np.conj(a - a.mean()))
    off = b.mean() + (a - a.mean()) * sum_ab / abs(sum_ab) - b
    return np.column_stack([off.real, off.imag])


def rms_um(error_mm: Floats) -> float:
    return 1e3 * float(np.sqrt(np.mean(np.sum(error_mm**2, axis=1))))


def test_predictions_for_corrected_commands_are_compared_with_the_wish() -> None:
    _, error_map = corrected().models
    # The commands were solved so that this model puts the arm where it shall stand.
    assert float(np.abs(error_map.prediction.error_mm).max()) < 1e-6


def test_measured_less_predicted_error_is_what_a_model_leaves() -> None:
    for model in corrected().models:
        left = model.comparison.measured_error_mm - model.prediction.error_mm
        np.testing.assert_allclose(left, model.comparison.difference_mm, atol=1e-9)


def points_of(lines: list[Line2D], marker: str) -> Floats:
    return np.vstack([np.asarray(one.get_xydata()) for one in lines if one.get_marker() == marker])


def test_the_panels_of_the_error_map_agree() -> None:
    axes = drawn(path_figures(corrected())[0]).axes
    # The right column is the error map, the first figure the deviation along the path.
    measured = np.vstack([points_of(list(axes[1].lines), marker) for marker in ("x", "+")])
    predicted = np.vstack([points_of(list(axes[1].lines), marker) for marker in ("o", "s")])
    assert float(np.abs(predicted[:, 1]).max()) < 0.01
    assert float(np.sqrt(np.mean(measured[:, 1] ** 2))) < 30.0
    titles = [one.get_title("left") for one in drawn(trajectory_figure(corrected())).axes]
    assert titles[:2] == ["a) measured", "b) error map"]


def test_all_panels_show_the_same_measurement() -> None:
    for figure in path_figures(corrected()):
        axes = drawn(figure).axes
        for marker in ("x", "+"):
            seen = [points_of(list(axes[panel].lines), marker) for panel in (0, 1)]
            np.testing.assert_allclose(seen[0], seen[1])
    # Below the conventional model stands what is drawn above it: between two frames a difference only turns.
    measured, predicted = shown_errors(corrected(), corrected().models[0])
    left_mm = corrected().models[0].comparison.difference_mm
    np.testing.assert_allclose(np.hypot(*(measured - predicted).T), np.hypot(*left_mm.T), atol=1e-9)


def test_the_gain_is_that_of_positions_against_the_wish() -> None:
    validation, plain = corrected(), sample.validation("x")
    before, measured, predicted, conventional = gains(validation)
    wished = validation.path.command_mm
    assert before.rms_um == pytest.approx(
        rms_um(aligned(plain.models[1].prediction.position_mm, wished)), rel=1e-6
    )
    assert measured.rms_um == pytest.approx(rms_um(aligned(validation.path.measured_mm, wished)), rel=1e-6)
    assert predicted.rms_um < 1e-3
    # What is left is the noise of 12 µm in x and in y.
    assert measured.rms_um == pytest.approx(12.0 * np.sqrt(2.0), rel=0.15)
    assert before.rms_um > 1.5 * measured.rms_um
    assert conventional.rms_um > measured.rms_um


def test_the_gain_stands_in_sentence_table_and_figure() -> None:
    (table, _, _), statement = gain_blocks(corrected()), gain_statement(corrected())
    assert statement is not None
    assert statement.sign is Sign.GOOD
    assert isinstance(table, Table)
    assert [row[0] for row in table.rows] == [
        "error map, without correction",
        "measured, corrected commands",
        "error map, corrected commands",
        "conventional model, corrected commands",
    ]
    labels = {str(line.get_label()) for line in drawn(gain_figure(corrected())).axes[0].lines}
    assert "with correction, measured, way there" in labels


def measured_file(folder: Path, names: str) -> Path:
    path = sample.corrected_path()
    commands = path.commands
    columns = {
        "theta1_deg": np.rad2deg(commands.theta1_rad),
        "theta2_deg": np.rad2deg(commands.theta2_rad),
        "direction1": commands.direction1,
        "direction2": commands.direction2,
        "x_meas_mm": path.measured_mm[:, 0],
        "y_meas_mm": path.measured_mm[:, 1],
        "x_wished_mm": path.command_mm[:, 0],
        "y_wished_mm": path.command_mm[:, 1],
    }
    rows = zip(*(columns[name].tolist() for name in names.split(",")), strict=True)
    text = "\n".join([names, *(",".join(repr(value) for value in row) for row in rows)])
    return text_file(folder, text, "measured.csv")


COMMANDED = "theta1_deg,theta2_deg,direction1,direction2,x_meas_mm,y_meas_mm"


def test_a_measured_file_may_name_the_wished_positions(tmp_path: Path) -> None:
    file = measured_file(tmp_path, f"{COMMANDED},x_wished_mm,y_wished_mm")
    path, _, _ = measured_path(file, NOMINAL, "right", (1, 1))
    found = validate_on_path(path, [one.arm for one in sample.measurement()[1]], NOMINAL)
    assert [one.rms_um for one in gains(found)][:2] == pytest.approx(
        [one.rms_um for one in gains(corrected())][:2], rel=0.05
    )
    with pytest.raises(UsageError, match="column x_wished_mm stands alone"):
        measured_path(measured_file(tmp_path, f"{COMMANDED},x_wished_mm"), NOMINAL, "right", (1, 1))


def test_a_path_of_nominal_commands_claims_no_gain() -> None:
    assert sample.validation("x").uncorrected_mm is None
    assert gain_blocks(sample.validation("x")) == []


def several() -> PathValidation:
    """Return the same path as two lines, there and back."""
    numbers = np.repeat([3, 5], 41)
    path = replace(sample.path("x"), numbers=numbers)
    return validate_on_path(path, [one.arm for one in sample.measurement()[1]], NOMINAL)


def test_several_lines_are_drawn_apart() -> None:
    axes = drawn(trajectory_figure(several())).axes[0]
    command = np.asarray(axes.lines[0].get_xydata())
    assert np.flatnonzero(np.isnan(command[:, 0])).tolist() == [41]
    assert {"3", "5"} <= {text.get_text() for text in axes.texts}


def test_the_axis_counts_no_way_from_line_to_line() -> None:
    x = np.array([0.0, 100.0, 100.0, 0.0])
    path = replace(
        sample.path("x"),
        commands=sample.path("x").commands.select(np.arange(4)),
        command_mm=np.column_stack([x, [0.0, 0.0, 300.0, 300.0]]),
        numbers=np.array([1, 1, 2, 2]),
    )
    axis = path_axis(path)
    assert axis.values_mm.tolist() == [0.0, 100.0, 100.0, 200.0]
    assert axis.title == "2 lines, 200 mm in the plane"


def test_each_line_has_its_own_figures() -> None:
    validation = several()
    table = line_table(validation)
    assert table is not None
    for row, own in zip(table.rows, (slice(0, 41), slice(41, 82)), strict=True):
        for value, model in zip(row[2:], validation.models, strict=True):
            assert value == pytest.approx(rms_um(model.comparison.difference_mm[own]))
    assert [row[:2] for row in table.rows] == [(3, 41), (5, 41)]
    assert line_table(sample.validation("x")) is None
