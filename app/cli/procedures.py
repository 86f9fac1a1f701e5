"""procedures: what can be run, what may be chosen, and what a cell is ready for."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import AsJson, Runs
from catseye.app.cli.output import note, write_json, write_line


def procedures(
    cell: Annotated[
        Path | None, typer.Option(help="cell file: say what each needs there, and what comes next")
    ] = None,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """List what can be run, with parameters, units and ranges; of a cell, what is needed and what comes next.

    Example: catseye procedures --cell cell.toml
    """
    if cell is None:
        _list_procedures(as_json=as_json)
    else:
        _survey(cell, runs, as_json=as_json)


def _list_procedures(*, as_json: bool) -> None:
    from catseye.app.cli.procedures_text import procedure_facts, procedure_lines
    from catseye.app.protocol.procedures import load_procedure, procedure_names

    for procedure in map(load_procedure, procedure_names()):
        if as_json:
            write_json(procedure_facts(procedure))
        else:
            write_line("\n".join(procedure_lines(procedure)))


def _survey(cell: Path, runs: Path | None, *, as_json: bool) -> None:
    from catseye.app.cli.procedures_text import survey_facts, survey_lines
    from catseye.app.results.readiness.survey import survey_cell
    from catseye.app.store.runs_folder import runs_folder

    survey = survey_cell(cell, runs_folder(runs), datetime.now(UTC))
    if as_json:
        for facts in survey_facts(survey):
            write_json(facts)
        return
    write_line("\n".join(survey_lines(survey)))
    if survey.next is not None:
        note(f"next: {survey.next.command}")
