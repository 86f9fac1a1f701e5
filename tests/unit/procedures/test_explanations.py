"""Every procedure is explained, and every parameter has a label with its unit and a description."""

import re
from collections.abc import Iterator
from typing import Any

import pytest

from catseye.app.protocol.procedures import parse_params, procedures
from catseye.procedures.kit.explanation import SKETCH_COLUMNS, SKETCH_LINES
from catseye.procedures.kit.procedure import Procedure

UNITS = {"mdeg": "mdeg", "deg": "deg", "mm": "mm", "um": "µm", "min": "min", "s": "s", "hz": "Hz"}
LABEL_COLUMNS = 23
INSTALLED = procedures()


def parameters() -> Iterator[tuple[str, str, dict[str, Any]]]:
    for procedure in INSTALLED:
        for key, facts in procedure.params_type.model_json_schema()["properties"].items():
            yield procedure.name, key, facts


@pytest.mark.parametrize("procedure", INSTALLED, ids=lambda procedure: procedure.name)
def test_a_procedure_has_a_paragraph_and_a_sketch(procedure: Procedure) -> None:
    found = procedure.explanation
    assert len(found.text.split(". ")) >= 2
    assert found.text.endswith(".")
    lines = found.sketch.splitlines()
    assert 5 <= len(lines) <= SKETCH_LINES
    assert max(map(len, lines)) <= SKETCH_COLUMNS


@pytest.mark.parametrize("procedure", INSTALLED, ids=lambda procedure: procedure.name)
def test_an_example_names_parameters_as_they_are(procedure: Procedure) -> None:
    given = procedure.explanation.example
    assert {text.partition("=")[0] for text in given} <= procedure.params_type.model_fields.keys()
    if "result=arm.json" not in given:
        # That one needs the file.
        parse_params(procedure.params_type, list(given))


def test_labels_have_the_unit_of_their_key() -> None:
    for procedure, key, facts in parameters():
        ending = re.search(r"_([a-z]+)$", key)
        unit = UNITS.get(ending[1], "") if ending else ""
        assert unit in facts["title"], (procedure, key)


def test_labels_fit_and_are_no_keys() -> None:
    for procedure, key, facts in parameters():
        written_by_pydantic = key.replace("_", " ").title()
        assert len(facts["title"]) <= LABEL_COLUMNS, (procedure, key)
        assert "_" not in facts["title"], (procedure, key)
        assert facts["title"] != written_by_pydantic or "_" not in key, (procedure, key)
        assert facts["description"], (procedure, key)


def test_labels_differ_within_a_procedure() -> None:
    for procedure in INSTALLED:
        facts = procedure.params_type.model_json_schema()["properties"].values()
        labels = [one["title"] for one in facts]
        assert len(set(labels)) == len(labels), procedure.name
