"""Procedures, and what a cell is ready for, as a report and as data."""

import json

from catseye.app.protocol.procedures import load_procedure
from catseye.app.render.text import report_text
from catseye.app.results.model import Sign
from catseye.app.results.readiness.need import Need
from catseye.app.results.readiness.stages import CellStage
from catseye.app.results.readiness.survey_document import (
    LastRun,
    SurveyDocument,
    procedure_entry,
    procedures_document,
)
from catseye.app.results.readiness.survey_report import procedures_report, survey_report, worst_sign

WARMUP = load_procedure("warmup")
NEEDS = (Need("reflectors", "met", "P1"), Need("search", "advised", "rough places only"))
LAST = LastRun(
    name="20261121T080000Z_warmup_00beef",
    procedure="warmup",
    status="stopped",
    age_s=7200.0,
    resumable=True,
    id="00beef",
    age="2 h ago",
)
SURVEY = SurveyDocument(
    cell="lab-1",
    procedures=(procedure_entry(WARMUP).model_copy(update={"needs": NEEDS, "last": LAST}),),
    stages=(CellStage("warmup", True, "next", "the arm at its working temperature", "catseye run warmup"),),
)


def test_needs_have_their_signs_and_stages_their_states() -> None:
    lines = report_text(survey_report(SURVEY)).splitlines()
    assert lines[:6] == [
        "What cell lab-1 is ready for",
        "",
        f"warmup: {WARMUP.title}",
        "  ✓ reflectors: P1",
        "  ! search: rough places only",
        "  · last run: 00beef: stopped, 2 h ago",
    ]
    assert lines[-1] == "  next   warmup         the arm at its working temperature"


def test_procedures_of_other_systems_stand_in_one_line() -> None:
    lacking = (Need("cell file", "missing", "it needs [[reflector]]"),)
    other = procedure_entry(load_procedure("beam-level")).model_copy(update={"needs": lacking})
    stated = SURVEY.model_copy(update={"procedures": (*SURVEY.procedures, other)})
    text = report_text(survey_report(stated))
    assert "[[reflector]]" not in text
    assert "· beam-level: the cell file does not describe what they need" in text
    # On its own way a procedure says what is missing.
    stage = CellStage("beam-level", True, "next", "a level beam", "catseye run beam-level")
    assert "[[reflector]]" in report_text(survey_report(stated.model_copy(update={"stages": (stage,)})))


def test_parameters_stand_with_range_and_default() -> None:
    text = report_text(procedures_report(procedures_document([load_procedure("beam-level")])))
    assert "distances at which the height is measured" in text
    assert "a whole number, 2 … 6; default 3" in text


def test_a_survey_is_read_back_as_it_was_written() -> None:
    text = "\n".join(json.dumps(line) for _, line in SURVEY.lines())
    assert SurveyDocument.of_lines(text) == SURVEY


def test_without_a_cell_procedures_have_neither_needs_nor_runs() -> None:
    ((_, line),) = procedures_document([WARMUP]).lines()
    assert list(line) == ["name", "title", "needs_aim", "about", "sketch", "example", "params"]


def test_lines_of_a_cell_keep_their_keys() -> None:
    (_, entry), (_, cell) = SURVEY.lines()
    assert list(entry) == [
        "name",
        "title",
        "needs_aim",
        "about",
        "sketch",
        "example",
        "params",
        "needs",
        "last",
    ]
    assert entry["needs"][0] == {"what": "reflectors", "met": "met", "text": "P1"}
    assert list(entry["last"]) == ["name", "procedure", "status", "age_s", "resumable", "void", "id", "age"]
    assert list(cell) == ["cell", "stages"]


def test_the_worst_need_signs_a_procedure() -> None:
    missing = Need("plan", "missing", "P2 is too near")
    assert [worst_sign(needs) for needs in ((), NEEDS, (*NEEDS, missing))] == [
        Sign.GOOD,
        Sign.ATTENTION,
        Sign.BAD,
    ]
