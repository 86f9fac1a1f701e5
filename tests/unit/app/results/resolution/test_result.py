"""Result files of motion resolution."""

import json
from pathlib import Path
from typing import Any

import pytest

from catseye.app.errors import UsageError
from catseye.app.results.resolution.result import (
    LinearTest,
    ResolutionResult,
    read_resolution,
    resolution_text,
    write_resolution,
)

_PROVENANCE = {"runs": [], "software": "catseye 0.2.0", "created": "2026-01-02T03:04:05+00:00"}

_JOINT = {
    "test": "decaying",
    "joint": "A1",
    "position_deg": -175.0,
    "direction": 1,
    "threshold_percent": 10.0,
    "moves": [{"command_deg": 0.1, "measured_deg": 0.101, "error_percent": 1.0}],
    "lis_deg": {"value": 1e-4, "u": 2e-5, "low": 7e-5, "high": 1.4e-4},
    "reversal_deg": None,
    "flags": [],
}
_LINE = {
    "test": "cartesian",
    "joint": "X",
    "position_mm": None,
    "direction": -1,
    "threshold_percent": 10.0,
    "moves": [{"command_mm": 1.0, "measured_mm": None, "error_percent": None}],
    "lis_mm": None,
    "reversal_mm": None,
    "flags": ["the step was not found"],
}


def _document(*tests: dict[str, Any]) -> dict[str, Any]:
    return {
        "format": "catseye-resolution/1",
        "arm": "kr210-r2700",
        "tests": list(tests),
        "provenance": _PROVENANCE,
    }


def _written(tmp_path: Path, document: object) -> Path:
    path = tmp_path / "result.json"
    path.write_text(json.dumps(document), "utf-8")
    return path


def test_a_document_is_written_as_it_was_read(tmp_path: Path) -> None:
    document = _document(dict(_JOINT), dict(_LINE))
    result = read_resolution(_written(tmp_path, document))
    again = json.loads(resolution_text(result))
    for test, given in zip(again["tests"], document["tests"], strict=True):
        (move,), (given_move,) = test.pop("moves"), given.pop("moves")
        assert given_move.items() <= move.items()
        assert given.items() <= test.items()
    assert again["arm"] == "kr210-r2700"


def test_keys_in_mm_make_a_linear_test(tmp_path: Path) -> None:
    result = read_resolution(_written(tmp_path, _document(_JOINT, _LINE)))
    assert [test.unit for test in result.tests] == ["deg", "mm"]
    assert isinstance(result.tests[1], LinearTest)


def test_units_are_not_mixed_in_one_test(tmp_path: Path) -> None:
    mixed = {**_LINE, "moves": _JOINT["moves"]}
    with pytest.raises(UsageError, match=r"tests\.0\.mm\.moves\.0\.command_mm: Field required"):
        read_resolution(_written(tmp_path, _document(mixed)))


def test_a_result_of_another_kind_names_the_command(tmp_path: Path) -> None:
    other = {"format": "catseye-result/1", "model": "error-map"}
    with pytest.raises(UsageError, match="not a catseye-resolution/1 file as catseye resolution writes it"):
        read_resolution(_written(tmp_path, other))


def test_further_keys_are_passed_over(tmp_path: Path) -> None:
    document = _document({**_JOINT, "operator": "somebody"})
    assert read_resolution(_written(tmp_path, document)).tests[0].joint == "A1"


def test_what_a_test_does_not_give_is_null(tmp_path: Path) -> None:
    path = tmp_path / "result.json"
    write_resolution(ResolutionResult.model_validate(_document(_LINE)), path)
    test = json.loads(path.read_text("utf-8"))["tests"][0]
    assert {key: test[key] for key in ("lis_mm", "reversal_mm", "position_mm")} == dict.fromkeys(
        ("lis_mm", "reversal_mm", "position_mm")
    )


def test_a_file_of_another_program_needs_the_binding_keys_only(tmp_path: Path) -> None:
    document = _document({key: _LINE[key] for key in ("test", "joint", "threshold_percent", "moves")})
    del document["provenance"]
    result = read_resolution(_written(tmp_path, document))
    assert result.provenance is None
    assert result.tests[0].unit == "mm"


def test_the_schema_names_keys_with_their_units() -> None:
    definitions = ResolutionResult.model_json_schema(by_alias=True)["$defs"]
    assert {"position_deg", "lis_deg", "reversal_deg"} <= definitions["AngularTest"]["properties"].keys()
    assert {"position_mm", "lis_mm", "reversal_mm"} <= definitions["LinearTest"]["properties"].keys()
