"""Results that somebody has edited: refused by name, before anything is made of them."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from catseye.app.errors import UsageError
from catseye.app.results.serial_arm.result import read_serial_arm, serial_arm_text
from tests.unit.app.results.serial_arm.sample import sample_calibration

Content = dict[str, Any]


def doubled(content: Content) -> None:
    content["parameters"].append(content["parameters"][1])


def doubled_frames(content: Content) -> None:
    content["frames"]["parameters"] = [content["parameters"][1]] * 2


def shortened(content: Content) -> None:
    content["correlation"].pop()


def one_row(content: Content) -> None:
    content["correlation"] = [1.0]


def not_identified(content: Content) -> None:
    content["parameters"][0]["identified"] = False


def too_large(content: Content) -> None:
    content["correlation"][0][1] = content["correlation"][1][0] = 5.0


def lopsided(content: Content) -> None:
    content["correlation"][0][1] = -0.5


def off_the_diagonal(content: Content) -> None:
    content["correlation"][1][1] = 0.5


def impossible(content: Content) -> None:
    """Two that go along with a third, and against one another."""
    content["correlation"] = [[1.0, 0.9, 0.9], [0.9, 1.0, -0.9], [0.9, -0.9, 1.0]]


def without_an_error(content: Content) -> None:
    content["errors"] = {
        "pose": ["P1", "P2"],
        "target": ["N1", "N1"],
        "place_mm": [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]],
        "frames_mm": [0.5],
        "left_out_mm": [None, 0.1],
    }


def empty_direction(content: Content) -> None:
    content["null_directions"] = [[]]


def in_another_unit(content: Content) -> None:
    content["parameters"][1]["unit"] = "m"


def compliance_in_another_unit(content: Content) -> None:
    content["parameters"][2]["unit"] = "rad/(N·m)"


def far_from_the_drawing(content: Content) -> None:
    content["parameters"][1]["value"] = 270000.0


def of_no_model(content: Content) -> None:
    content["model"] = "nonsense"


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (in_another_unit, "J2.a_mm is stated in m, and its name says mm"),
        (compliance_in_another_unit, r"J2.compliance_rad_per_nmm is stated in rad/\(N·m\)"),
        (far_from_the_drawing, "J2.a_mm is 270000 and nominally 0"),
        (of_no_model, "model: Input should be 'frames', 'geometric'"),
        (without_an_error, "errors have not one value a point"),
        (empty_direction, "null_directions"),
        (doubled, "J2.a_mm stands twice"),
        (doubled_frames, "J2.a_mm stands twice"),
        (shortened, "correlation is not the matrix of 3 identified parameters"),
        (one_row, "correlation"),
        (not_identified, "correlation is not the matrix of 2 identified parameters"),
        (too_large, "correlation has 5 in row 1, column 2"),
        (lopsided, "correlation has -0.5 in row 1, column 2"),
        (off_the_diagonal, "correlation has 0.5 in row 2, column 2"),
        (impossible, "coefficients that no errors can have together"),
    ],
)
def test_edited_result_is_refused_by_name(tmp_path: Path, edit: Callable[[Content], None], said: str) -> None:
    content = json.loads(serial_arm_text(sample_calibration()))
    edit(content)
    path = tmp_path / "edited.json"
    path.write_text(json.dumps(content), "utf-8")
    with pytest.raises(UsageError, match=said) as refused:
        read_serial_arm(path)
    assert str(path) in str(refused.value)


def test_rounded_coefficients_are_taken(tmp_path: Path) -> None:
    content = json.loads(serial_arm_text(sample_calibration()))
    content["correlation"] = [[1.0, 0.999, 0.5], [0.999, 1.0, 0.45], [0.5, 0.45, 1.0]]
    path = tmp_path / "rounded.json"
    path.write_text(json.dumps(content), "utf-8")
    assert read_serial_arm(path).correlation[0][1] == 0.999


def test_empty_provenance_is_taken_for_none(tmp_path: Path) -> None:
    content = json.loads(serial_arm_text(sample_calibration()))
    content["provenance"] = {}
    path = tmp_path / "bare.json"
    path.write_text(json.dumps(content), "utf-8")
    assert read_serial_arm(path).provenance is None
