"""procedures: what can be run, what may be chosen, and what a cell is ready for."""

from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from catseye.app.cli.output import emit, emit_json, say
from catseye.app.guidance.survey import Survey, survey_cell
from catseye.app.guidance.words import age_text
from catseye.app.parameter_words import default_text, range_text
from catseye.app.procedure_list import Runnable, load_procedure, procedure_names
from catseye.app.runs_folder import runs_folder

_SIGNS = {"met": "✓", "advised": "!", "missing": "✗"}


def procedures_command(cell: Path | None, runs: Path | None, as_json: bool) -> None:
    """List the installed procedures; of a cell, what each needs there and what comes next."""
    if cell is None:
        for name in procedure_names():
            _tell_procedure(load_procedure(name), as_json=as_json)
        return
    survey = survey_cell(cell, runs_folder(runs), datetime.now(UTC))
    if as_json:
        _tell_survey_json(survey)
    else:
        _tell_survey(survey)


def _tell_procedure(procedure: Runnable, *, as_json: bool) -> None:
    if as_json:
        emit_json(_facts(procedure))
        return
    emit(f"{procedure.name}: {procedure.title}")
    for key, facts in _schema(procedure).items():
        default = default_text(facts)
        emit(f"    {key:<20} {facts.get('description', '')}")
        emit(f"    {'':<20} {range_text(facts)}{f'; default {default}' if default else ''}")


def _tell_survey_json(survey: Survey) -> None:
    for procedure in survey.procedures:
        last = survey.runs.last(procedure.name)
        emit_json(
            {
                **_facts(procedure),
                "needs": [asdict(need) for need in survey.needs[procedure.name]],
                "last": None
                if last is None
                else {**asdict(last), "id": last.id, "age": age_text(last.age_s)},
            }
        )
    emit_json({"cell": survey.cell, "stages": [asdict(stage) for stage in survey.stages]})


def _tell_survey(survey: Survey) -> None:
    for procedure in survey.procedures:
        emit(f"{procedure.name}: {procedure.title}")
        for need in survey.needs[procedure.name]:
            emit(f"    {_SIGNS[need.met]} {need.what:<12} {need.text}")
        last = survey.runs.last(procedure.name)
        emit(f"    last run       {f'{last.id}: {last.status}, {age_text(last.age_s)}' if last else 'none'}")
    emit("")
    for stage in survey.stages:
        emit(f"{'→' if stage.state == 'next' else ' '} {stage.name:<17} {stage.state:<9} {stage.text}")
    if survey.next is not None:
        say(f"next: {survey.next.command}")


def _facts(procedure: Runnable) -> dict[str, Any]:
    return {
        "name": procedure.name,
        "title": procedure.title,
        "needs_aim": procedure.needs_aim,
        "params": _schema(procedure),
    }


def _schema(procedure: Runnable) -> dict[str, Any]:
    properties: dict[str, Any] = procedure.params_type.model_json_schema()["properties"]
    return properties
