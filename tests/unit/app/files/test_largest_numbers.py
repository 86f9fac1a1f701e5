"""Numbers that no measurement has are refused where they stand, before their squares are no numbers."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from catseye.app.errors import ConfigError, UsageError
from catseye.app.files.diadem import read_trace
from catseye.app.files.foreign_csv import found_dialect, read_numbers
from catseye.app.results.resolution.result import read_resolution, resolution_text
from catseye.app.results.scara.path_csv import read_path_csv
from catseye.app.results.scara.result import read_result, result_text
from catseye.app.results.serial_arm.verdict import verdict
from catseye.app.tui.keys import read_keymap
from catseye.drivers.counter.profile import built_in_text, load_profile
from catseye.drivers.roles.errors import ProfileError
from tests.unit.app.results.resolution.sample import sample_result
from tests.unit.app.results.scara import sample
from tests.unit.app.results.serial_arm.sample import sample_calibration


def written(folder: Path, text: str, name: str = "table.csv") -> Path:
    path = folder / name
    path.write_text(text, "utf-8")
    return path


@pytest.mark.parametrize(("number", "said"), [("1e308", "more than 1e.30"), ("-1e31", "less than -1e.30")])
def test_a_huge_number_of_a_table_is_named(tmp_path: Path, number: str, said: str) -> None:
    path = written(tmp_path, f"x_mm,y_mm\n300,200\n{number},200\n")
    with pytest.raises(UsageError, match=rf"table\.csv:3: x_mm = .* is {said}"):
        read_path_csv(path, (325.0, 225.0))


def test_a_huge_number_of_another_program_is_named(tmp_path: Path) -> None:
    path = written(tmp_path, "t;d\n0;1\n1;2\n2;1e308\n")
    with pytest.raises(UsageError, match=r"table\.csv:4: column 2 holds '1e308'"):
        read_numbers(path, found_dialect(path), (0, 1))


def _node(document: Any) -> None:
    document["theta1_map"]["node_deg"][0] = -1e308


def _uncertainty(document: Any) -> None:
    document["link1_mm"]["u"] = 1e308


@pytest.mark.parametrize("edit", [_node, _uncertainty])
def test_a_huge_number_of_a_result_is_named(tmp_path: Path, edit: Callable[[Any], None]) -> None:
    document = json.loads(result_text(sample.hand_made()))
    edit(document)
    with pytest.raises(UsageError, match=r"edited\.json: .*(greater|less) than or equal to"):
        read_result(written(tmp_path, json.dumps(document), "edited.json"))


def test_a_judged_step_of_no_size_is_refused(tmp_path: Path) -> None:
    document = json.loads(resolution_text(sample_result()))
    move = next(move for test in document["tests"] for move in test["moves"] if move["judged"])
    move[next(key for key in move if key.startswith("command"))] = 0.0
    with pytest.raises(UsageError, match=r"edited\.json: .*a step of 0 has no error in percent"):
        read_resolution(written(tmp_path, json.dumps(document), "edited.json"))


def test_a_trace_without_any_header_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"trace\.dat: has no header"):
        read_trace(written(tmp_path, "DIAEXTENDED\n", "trace.dat"))


def test_a_huge_number_of_a_drawing_names_its_segment(tmp_path: Path) -> None:
    text = '[[segment]]\nkind = "line"\nfrom = [350.0, 0.0]\nto = [1e300, 0.0]\npoints = 3\n'
    with pytest.raises(UsageError, match=r"path\.toml: segment 1: x_mm is more than 1e.30"):
        read_path_csv(written(tmp_path, text, "path.toml"), (325.0, 225.0))


def test_a_pattern_that_cannot_be_compiled_is_named(tmp_path: Path) -> None:
    text = built_in_text("default").replace("(?P<value>", "a{99999999999}(?P<value>", 1)
    assert "a{99999999999}" in text
    with pytest.raises(ProfileError, match=r"own\.toml: .*not a regular expression"):
        load_profile(str(written(tmp_path, text, "own.toml")))


def test_a_long_value_of_a_key_is_shown_in_part(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"keys\.toml: go\.jog = .* is no key") as caught:
        read_keymap(written(tmp_path, f'"go.jog" = ["{"x" * 100_000}"]\n', "keys.toml"))
    assert len(str(caught.value)) < 1000


def test_a_residual_without_bound_is_named(tmp_path: Path) -> None:
    document = json.loads(result_text(sample.hand_made()))
    document["residuals"]["theta1_deg"][0] = 1e308
    with pytest.raises(UsageError, match=r"edited\.json: .*residuals\.theta1_deg\.0"):
        read_result(written(tmp_path, json.dumps(document), "edited.json"))


@pytest.mark.parametrize("chi2", [0.0, 1e-30])
def test_residuals_of_nothing_are_reported(chi2: float) -> None:
    result = sample_calibration()
    exact = result.model_copy(update={"fit": result.fit.model_copy(update={"chi2_reduced": chi2})})
    assert any("more than a million times" in said.text for said in verdict(exact))
