"""procedures: what can be run, what may be chosen, and what a cell is ready for."""

import asyncio
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from catseye.app.cli import completion
from catseye.app.cli.options import AsJson, Runs
from catseye.app.cli.output import note, warn, write_document, write_line
from catseye.app.cli.surveyed import bench_now, surveyed
from catseye.app.errors import ConfigError, UsageError
from catseye.app.render.text import report_text
from catseye.app.store.runs_folder import runs_folder

if TYPE_CHECKING:
    from catseye.app.results.model import Report
    from catseye.app.results.readiness.need import Need
    from catseye.app.results.readiness.stages import CellStage
    from catseye.app.results.readiness.survey import Scope, Survey
    from catseye.app.results.readiness.survey_document import SurveyDocument


def procedures(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="[NAME]",
            help="explain this procedure: what it does, a sketch, an example, its parameters",
            autocompletion=completion.procedures,
        ),
    ] = None,
    cell: Annotated[
        Path | None,
        typer.Option(help="cell file: also show what each procedure needs there, and what comes next"),
    ] = None,
    campaign: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="list the stages of a campaign, with its parameters and limits"),
    ] = None,
    job: Annotated[str, typer.Option(metavar="ID", help="with --campaign: only runs of this job count")] = "",
    runs: Runs = None,
    as_json: AsJson = False,
    offline: Annotated[bool, typer.Option("--offline", help="do not ask the controller for alarms")] = False,
) -> None:
    """List the procedures and their parameters. With --cell, also what each one needs and what comes next.

    Example: catseye procedures --cell cell.toml
    """
    if campaign is not None and cell is None:
        raise UsageError("--campaign lists stages of a cell: add --cell FILE")
    if name is not None:
        _explain(name, cell, runs, as_json=as_json)
    elif cell is None:
        _list_procedures(as_json=as_json)
    else:
        _survey(cell, runs, campaign, job, as_json=as_json, offline=offline)


def _explain(name: str, cell: Path | None, runs: Path | None, *, as_json: bool) -> None:
    from catseye.app.cli.procedure_text import procedure_text
    from catseye.app.protocol.procedures import load_procedure
    from catseye.app.results.readiness.survey_document import procedures_document, survey_document

    # An unknown name ends here, before every plan is tried on the cell.
    document = procedures_document([load_procedure(name)])
    if cell is not None:
        document = survey_document(surveyed(cell, runs_folder(runs), datetime.now(UTC), bench_now(cell)))
    entry = document.procedure(name)
    if entry is None:
        raise UsageError(f"{name} is not among the procedures of {cell}")
    if as_json:
        write_document(
            "procedure", entry.model_dump(mode="json", exclude=set() if cell else {"needs", "last"})
        )
    else:
        write_line(procedure_text(document, entry))


def _list_procedures(*, as_json: bool) -> None:
    from catseye.app.protocol.procedures import procedures as installed
    from catseye.app.results.readiness.survey_document import procedures_document
    from catseye.app.results.readiness.survey_report import procedures_report

    document = procedures_document(installed())
    _warn_of_broken()
    _write(document, procedures_report(document), as_json=as_json)
    if not as_json:
        note("catseye procedures NAME explains one of them")


def _warn_of_broken() -> None:
    """Name what was left out because it cannot be loaded."""
    from catseye.app.protocol.procedures import broken_procedures

    for text in broken_procedures():
        warn(text)


def _survey(
    cell: Path, runs: Path | None, campaign: Path | None, job: str, *, as_json: bool, offline: bool
) -> None:
    from catseye.app.results.readiness.survey_document import survey_document
    from catseye.app.results.readiness.survey_report import survey_report

    root = runs_folder(runs)
    with ThreadPoolExecutor(1) as beside:
        # A controller that does not answer keeps nobody waiting: plans are tried meanwhile.
        looked = None if offline else beside.submit(_alarm_needs, cell, root)
        survey = surveyed(cell, root, datetime.now(UTC), bench_now(cell), scope=_scope(root, job))
        if campaign is not None:
            survey = replace(survey, stages=_stages_of(campaign, survey, root, job))
        document = survey_document(survey, *([] if looked is None else looked.result()))
    _warn_of_broken()
    _write(document, survey_report(document), as_json=as_json)
    if document.next is not None and not as_json:
        note(f"next: {document.next.command}")


def _scope(root: Path, job: str) -> "Scope | None":
    from catseye.app.campaign.job import jobs_folder
    from catseye.app.results.readiness.survey import Scope

    return Scope(job, jobs_folder(root) / job) if job else None


def _stages_of(campaign: Path, survey: "Survey", root: Path, job: str) -> "list[CellStage]":
    """Return the stages of a campaign on a cell."""
    from functools import partial

    from catseye.app.campaign.checks import require_doable
    from catseye.app.campaign.day import day_of_campaign
    from catseye.app.campaign.documents import document_of, stored_document
    from catseye.app.campaign.job import jobs_folder
    from catseye.app.campaign.load import load_campaign
    from catseye.app.cli.lazy import options_of_command

    loaded = load_campaign(campaign)
    require_doable(loaded, survey.stages, survey.procedures, options_of_command)
    folder = jobs_folder(root) / job if job else None
    documents = partial(document_of, of_run=partial(stored_document, root), folder=folder)
    return day_of_campaign(loaded, survey.stages, documents)


def _alarm_needs(cell: Path, root: Path) -> "list[Need]":
    """Return that the controller is in no alarm, or in which; nothing where nobody can say."""
    from catseye.app.cell.load import load_cell
    from catseye.app.results.readiness.need import alarm_need
    from catseye.app.service.alarm import alarm_if_seen

    try:
        alarm = asyncio.run(alarm_if_seen(load_cell(cell).cell, root))
    except ConfigError:
        # The survey says it.
        return []
    return [] if alarm is None else [alarm_need(alarm.number, alarm.text, resets=alarm.resets)]


def _write(document: "SurveyDocument", report: "Report", *, as_json: bool) -> None:
    if as_json:
        for name, line in document.lines():
            write_document(name, line)
    else:
        write_line(report_text(report))
