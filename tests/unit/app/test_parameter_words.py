"""What parameters may be, in words that a technician can act on."""

import pytest
from pydantic import BaseModel

from app.errors import UsageError
from app.parameter_words import range_text
from app.procedure_list import load_procedure, parse_params, procedure_names
from procedures.open_loop.open_loop import OpenLoopParams


@pytest.mark.parametrize(
    ("facts", "text"),
    [
        ({"type": "integer", "minimum": 4, "maximum": 40}, "a whole number, 4 … 40"),
        ({"type": "number", "exclusiveMinimum": 0.0, "maximum": 45.0}, "more than 0, at most 45"),
        (
            {"anyOf": [{"type": "number", "minimum": -360.0, "maximum": 360.0}, {"type": "null"}]},
            "-360 … 360",
        ),
        ({"enum": ["automatic", "manual"], "type": "string"}, "automatic or manual"),
        ({"type": "array", "items": {"type": "string"}}, 'a list of names, such as ["P1", "P2"]'),
        ({"type": "boolean"}, "true or false"),
    ],
)
def test_a_range_reads_plainly(facts: dict[str, object], text: str) -> None:
    assert range_text(facts) == text


@pytest.mark.parametrize("name", procedure_names())
def test_every_number_of_every_procedure_has_a_range(name: str) -> None:
    schema = load_procedure(name).params_type.model_json_schema()["properties"]
    for key, facts in schema.items():
        text = range_text(facts)
        assert facts.get("description"), key
        assert "None" not in text, key
        assert text not in {"a number", "a whole number", "a value"}, key


@pytest.mark.parametrize(
    ("params", "given", "told"),
    [
        (
            OpenLoopParams,
            "closures=300",
            "--param closures: 300 is not possible; it takes a whole number, 0 … 20",
        ),
        (
            OpenLoopParams,
            "reflectors=P9",
            'P9 is not possible; it takes a list of names, such as ["P1", "P2"]',
        ),
    ],
)
def test_a_wrong_value_is_told_with_what_is_possible(params: type[BaseModel], given: str, told: str) -> None:
    with pytest.raises(UsageError) as caught:
        parse_params(params, [given])
    assert told in str(caught.value)
