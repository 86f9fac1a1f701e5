"""procedures: what can be run, what may be chosen, and what a cell is ready for."""

from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from catseye.app.cli.options import AsJson, Runs
from catseye.app.cli.output import note, write_json, write_line
from catseye.app.cli.surveyed import bench_now, surveyed
from catseye.app.render.text import report_text
from catseye.app.store.runs_folder import runs_folder

if TYPE_CHECKING:
    from catseye.app.results.model import Report
    from catseye.app.results.readiness.survey_document import SurveyDocument


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
    from catseye.app.protocol.installed import procedure_names
    from catseye.app.protocol.procedures import load_procedure
    from catseye.app.results.readiness.survey_document import procedures_document
    from catseye.app.results.readiness.survey_report import procedures_report

    document = procedures_document(map(load_procedure, procedure_names()))
    _write(document, procedures_report(document), as_json=as_json)


def _survey(cell: Path, runs: Path | None, *, as_json: bool) -> None:
    from catseye.app.results.readiness.survey_document import survey_document
    from catseye.app.results.readiness.survey_report import survey_report

    survey = surveyed(cell, runs_folder(runs), datetime.now(UTC), bench_now(cell))
    document = survey_document(survey)
    _write(document, survey_report(document), as_json=as_json)
    if document.next is not None and not as_json:
        note(f"next: {document.next.command}")


def _write(document: "SurveyDocument", report: "Report", *, as_json: bool) -> None:
    if as_json:
        for line in document.lines():
            write_json(line)
    else:
        write_line(report_text(report))
