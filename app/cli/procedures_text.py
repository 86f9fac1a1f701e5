"""What can be run, and what a cell is ready for, as lines and as data."""

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from catseye.app.protocol.parameters import default_text, range_text
from catseye.app.protocol.procedures import Runnable
from catseye.app.results.numbers import age_text
from catseye.app.results.readiness.survey import Survey

_SIGNS = {"met": "✓", "advised": "!", "missing": "✗"}


def procedure_facts(procedure: Runnable) -> dict[str, Any]:
    """Return a procedure and the schema of its parameters."""
    return {
        "name": procedure.name,
        "title": procedure.title,
        "needs_aim": procedure.needs.basis is not None,
        "params": _schema(procedure),
    }


def procedure_lines(procedure: Runnable) -> Iterator[str]:
    """Return a procedure and its parameters, with units, ranges and defaults."""
    yield f"{procedure.name}: {procedure.title}"
    for key, facts in _schema(procedure).items():
        default = default_text(facts)
        yield f"    {key:<20} {facts.get('description', '')}"
        yield f"    {'':<20} {range_text(facts)}{f'; default {default}' if default else ''}"


def survey_facts(survey: Survey) -> Iterator[dict[str, Any]]:
    """Return each procedure with its needs and last run, then the stages of the cell."""
    for procedure in survey.procedures:
        last = survey.runs.last(procedure.name)
        yield {
            **procedure_facts(procedure),
            "needs": [asdict(need) for need in survey.needs[procedure.name]],
            "last": None if last is None else {**asdict(last), "id": last.id, "age": age_text(last.age_s)},
        }
    yield {"cell": survey.cell, "stages": [asdict(stage) for stage in survey.stages]}


def survey_lines(survey: Survey) -> Iterator[str]:
    """Return the same as lines."""
    for procedure in survey.procedures:
        yield f"{procedure.name}: {procedure.title}"
        for need in survey.needs[procedure.name]:
            yield f"    {_SIGNS[need.met]} {need.what:<12} {need.text}"
        last = survey.runs.last(procedure.name)
        yield f"    last run       {f'{last.id}: {last.status}, {age_text(last.age_s)}' if last else 'none'}"
    yield ""
    for stage in survey.stages:
        yield f"{'→' if stage.state == 'next' else ' '} {stage.name:<17} {stage.state:<9} {stage.text}"


def _schema(procedure: Runnable) -> dict[str, Any]:
    properties: dict[str, Any] = procedure.params_type.model_json_schema()["properties"]
    return properties
