"""What parameters may be, in words that a technician can act on."""

from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel

from catseye.app.errors import UsageError
from catseye.app.protocol.installed import procedure_names
from catseye.app.protocol.parameters import (
    names_in,
    param_text,
    range_text,
    short_text,
    typed_fault,
    value_text,
)
from catseye.app.protocol.procedures import load_procedure, parse_params
from catseye.procedures.scara.open_loop.open_loop import OpenLoopParams


@pytest.mark.parametrize(
    ("facts", "text"),
    [
        ({"type": "integer", "minimum": 4, "maximum": 40}, "a whole number, 4 … 40"),
        ({"type": "number", "exclusiveMinimum": 0.0, "maximum": 45.0}, "more than 0, at most 45"),
        ({"type": "number", "exclusiveMinimum": 0.0}, "more than 0"),
        ({"type": "integer", "minimum": 1}, "a whole number, at least 1"),
        ({"type": "number", "maximum": 3.0}, "at most 3"),
        ({"type": "number", "minimum": 0.0, "exclusiveMaximum": 1.0}, "at least 0, less than 1"),
        (
            {"anyOf": [{"type": "number", "minimum": -360.0, "maximum": 360.0}, {"type": "null"}]},
            "-360 … 360",
        ),
        ({"enum": ["automatic", "manual"], "type": "string"}, "automatic or manual"),
        ({"type": "array", "items": {"type": "string"}}, "names, separated by commas"),
        ({"type": "boolean"}, "true or false"),
    ],
)
def test_a_range_reads_plainly(facts: dict[str, object], text: str) -> None:
    assert range_text(facts) == text


@pytest.mark.parametrize(
    ("facts", "text"),
    [
        ({"type": "number", "exclusiveMinimum": 0.0, "maximum": 45.0}, "> 0 … 45"),
        ({"type": "number", "exclusiveMinimum": 0.0}, "> 0"),
        ({"type": "integer", "minimum": 1}, "≥ 1"),
        ({"type": "number", "minimum": 0.0, "exclusiveMaximum": 1.0}, "0 … < 1"),
        ({"type": "number", "maximum": 3.0}, "≤ 3"),
    ],
)
def test_a_range_in_few_characters(facts: dict[str, object], text: str) -> None:
    assert short_text(facts) == text


@pytest.mark.parametrize(("text", "fault"), [("1", "less than 1"), ("0.999", "")])
def test_an_open_end_is_no_part_of_the_range(text: str, fault: str) -> None:
    assert typed_fault({"type": "number", "exclusiveMaximum": 1.0}, text) == fault


@pytest.mark.parametrize("name", procedure_names())
def test_every_number_of_every_procedure_has_a_range(name: str) -> None:
    schema = load_procedure(name).params_type.model_json_schema()["properties"]
    for key, facts in schema.items():
        text = range_text(facts)
        assert facts.get("description"), key
        assert "None" not in text, key
        assert text not in {"a number", "a whole number", "a value"}, key


@pytest.mark.parametrize(
    ("params", "given", "message"),
    [
        (
            OpenLoopParams,
            "closures=300",
            "--param closures: 300 is not possible; it takes a whole number, 0 … 20",
        ),
        (
            OpenLoopParams,
            "reflectors=9",
            "9 is not possible; it takes names, separated by commas",
        ),
    ],
)
def test_a_wrong_value_is_reported_with_what_is_possible(
    params: type[BaseModel], given: str, message: str
) -> None:
    with pytest.raises(UsageError) as caught:
        parse_params(params, [given])
    assert message in str(caught.value)


def test_a_parameter_without_default_is_asked_for() -> None:
    with pytest.raises(UsageError) as caught:
        parse_params(load_procedure("ballbar").params_type, [])
    assert str(caught.value) == "--param result=… has to be given; it takes the name of a file"


def test_names_need_no_brackets_on_the_command_line() -> None:
    given = parse_params(OpenLoopParams, ["reflectors=P1, P2"])
    assert isinstance(given, OpenLoopParams)
    assert given.reflectors == ["P1", "P2"]


def facts_of(name: str, key: str) -> dict[str, Any]:
    schema: dict[str, Any] = load_procedure(name).params_type.model_json_schema()["properties"][key]
    return schema


@pytest.mark.parametrize(
    ("name", "key", "good", "bad"),
    [
        ("reflector-search", "poses", ["4", "40", " 8 ", ""], ["3", "41", "8.0", "many"]),
        ("reflector-search", "most_poses", ["", "4", "120"], ["3", "121", "null"]),
        ("reflector-search", "half_range_deg", ["0.1", "45", "1e1"], ["0", "45.1", "nan", "6 deg", "-1"]),
        ("reflector-search", "mode", ["automatic", "manual"], ["auto"]),
        ("open-loop", "subdivide", ["true", "false"], ["yes", "1"]),
        ("open-loop", "reflectors", ["P1, P2", '["P1"]'], ['["P1"', "[1]"]),
        ("warmup", "reference_deg", ["[0, 90]", ""], ["[0]", "0, 90", "[0, 361]"]),
        ("repeatability", "poses", ["5", "[[0, 10], [20, 30]]"], ["51", "[[0]]", "[]"]),
        ("validation-path", "joints", ["path.csv"], []),
    ],
)
def test_typed_values_are_judged_as_the_procedure_will_judge_them(
    name: str, key: str, good: list[str], bad: list[str]
) -> None:
    facts, params_type = facts_of(name, key), load_procedure(name).params_type
    for text in good:
        assert typed_fault(facts, text) == "", text
        if text and "file" not in facts:
            parse_params(params_type, [param_text(facts, key, text)])
    for text in bad:
        assert typed_fault(facts, text) == range_text(facts), text
        with pytest.raises(UsageError):
            parse_params(params_type, [f"{key}={text}"])


def test_a_name_that_looks_like_a_number_stays_a_name() -> None:
    assert param_text(facts_of("warmup", "reflector"), "reflector", "1") == 'reflector="1"'


def test_a_file_is_named_from_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    typed = param_text(facts_of("validation-path", "joints"), "joints", "a.csv")
    assert typed == f'joints="{tmp_path / "a.csv"}"'


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, ""), ("", ""), ([], ""), (True, "true"), (8.0, "8"), ("P1", "P1"), ([1, 2], "[1, 2]")],
)
def test_values_as_they_are_typed(value: object, text: str) -> None:
    assert value_text(value) == text


def test_names_are_typed_with_or_without_brackets() -> None:
    for text in ("N1, N 2", '["N1", "N 2"]'):
        assert names_in(text) == ["N1", "N 2"]
    assert names_in("") == []
