"""Procedures, and what a cell is ready for, as a report."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from catseye.app.protocol.parameters import default_text, parameter_label, range_text
from catseye.app.results.model import Block, Column, Entries, Report, Section, Sign, Statement, Table, section
from catseye.app.results.origin import origin_now
from catseye.app.results.readiness.need import Met, Need

if TYPE_CHECKING:
    # The first screen of the terminal UI is painted before this is imported.
    from catseye.app.results.readiness.survey_document import LastRun, ProcedureEntry, SurveyDocument

_SIGNS: Final[dict[Met, Sign]] = {"met": Sign.GOOD, "advised": Sign.ATTENTION, "missing": Sign.BAD}
_WORST_FIRST: Final = (Sign.BAD, Sign.ATTENTION, Sign.GOOD)


def procedures_report(survey: "SurveyDocument") -> Report:
    """Return the procedures with their parameters; of a cell, with what each needs there."""
    return Report(
        "Procedures",
        origin_now(),
        tuple(
            _procedure_section(
                entry, [*(readiness(entry.needs, entry.last) if survey.cell else ()), _parameters(entry)]
            )
            for entry in survey.procedures
        ),
    )


def survey_report(survey: "SurveyDocument") -> Report:
    """Return what each procedure of the cell's system needs there, which are of others, and the way of the cell."""
    others = [entry for entry in survey.procedures if _is_of_another_system(entry, survey)]
    sections = [
        _procedure_section(entry, readiness(entry.needs, entry.last))
        for entry in survey.procedures
        if entry not in others
    ]
    if others:
        named = ", ".join(entry.name for entry in others)
        text = f"{named}: the cell file does not describe what they need; catseye procedures lists them"
        sections.append(section("others", "Of other systems", [Statement(Sign.NEUTRAL, text)], brief=True))
    return Report(
        f"What cell {survey.cell} is ready for",
        origin_now(),
        (*sections, section("stages", "The way to a validated result", [_stages(survey)], brief=True)),
    )


def _is_of_another_system(entry: "ProcedureEntry", survey: "SurveyDocument") -> bool:
    """Return whether the cell file lacks what a procedure needs, and the cell is led along another way."""
    lacks = any(need.what == "cell file" and need.met == "missing" for need in entry.needs)
    return lacks and entry.name not in {stage.name for stage in survey.stages}


def readiness(needs: Sequence[Need], last: "LastRun | None") -> list[Statement]:
    """Return what is needed and whether it is there, and the last run."""
    run = "none on this cell" if last is None else f"{last.id}: {last.status}, {last.age}"
    if last is not None and last.void:
        run = f"{run}; it no longer counts, {last.void}"
    return [*map(need_statement, needs), Statement(Sign.NEUTRAL, f"last run: {run}")]


def need_statement(need: Need) -> Statement:
    """Return whether a need is met, and what to do."""
    return Statement(_SIGNS[need.met], f"{need.what}: {need.text}")


def worst_sign(needs: Sequence[Need]) -> Sign:
    """Return the sign of what is least met; good when nothing is needed."""
    signs = {_SIGNS[need.met] for need in needs}
    return next((sign for sign in _WORST_FIRST if sign in signs), Sign.GOOD)


def _procedure_section(entry: "ProcedureEntry", blocks: Sequence[Block]) -> Section:
    return section(entry.name, f"{entry.name}: {entry.title}", blocks, brief=True)


def _parameters(entry: "ProcedureEntry") -> Entries:
    """Return the parameters with units, ranges and defaults."""
    return Entries(
        tuple(
            (
                name,
                f"{parameter_label(name, schema)}: {schema.get('description', '')}\n{_range_and_default(schema)}",
            )
            for name, schema in entry.params.items()
        )
    )


def _range_and_default(schema: dict[str, object]) -> str:
    default = default_text(schema)
    return range_text(schema) + (f"; default {default}" if default else "")


def _stages(survey: "SurveyDocument") -> Table:
    columns = (
        Column("state", "state"),
        Column("name", "stage"),
        Column("found", "found"),
        Column("text", "text"),
    )
    return Table(
        "stages", "Stages", columns, tuple((s.state, s.name, s.found, s.text) for s in survey.stages)
    )
