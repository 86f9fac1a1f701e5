"""campaign: the stages of a day or a night from a file, without anybody there."""

import asyncio
import sys
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from catseye.app.cli import completion
from catseye.app.cli.options import Answers, Arm, AsJson, Metrics, Runs, WaiveWalk
from catseye.app.cli.output import note, write_document, write_line
from catseye.app.errors import UsageError
from catseye.app.store.runs_folder import runs_folder

if TYPE_CHECKING:
    # It imports much of the program, which the listing of the shipped files does not need.
    from catseye.app.cli.campaigning import Wanted

CampaignFile = Annotated[
    Path | None,
    typer.Argument(
        metavar="[FILE]",
        help="campaign file, or the name of one that comes with the program; without it those are listed",
        autocompletion=completion.campaigns,
    ),
]
Cell = Annotated[Path | None, typer.Option("--cell", help="cell file")]
JobId = Annotated[
    str,
    typer.Option(
        "--job",
        metavar="ID",
        help="job to begin, or to continue where it ended [a new one, named by the time]",
    ),
]
Deadline = Annotated[
    str,
    typer.Option(metavar="TIME", help="when the job has to be over: 06:30, 8h, 90min, or an ISO 8601 time"),
]
WaitLock = Annotated[
    float,
    typer.Option("--wait-lock", metavar="S", min=0.0, help="longest wait for another job of the cell, s"),
]
DryRun = Annotated[
    bool,
    typer.Option("--dry-run", help="say what would be done and how long it took the last time; do nothing"),
]
CampaignSpeed = Annotated[
    float | None,
    typer.Option(min=0.001, max=1e6, help="bench seconds in one real second; emulators only"),
]


def campaign(
    file: CampaignFile = None,
    cell: Cell = None,
    job: JobId = "",
    deadline: Deadline = "",
    wait_lock: WaitLock = 0.0,
    answers: Answers = None,
    arm: Arm = None,
    speed: CampaignSpeed = None,
    waive_walk: WaiveWalk = None,
    runs: Runs = None,
    as_json: AsJson = False,
    metrics: Metrics = None,
    dry_run: DryRun = False,
) -> None:
    """Carry out the stages of a day or a night. Says of each stage whether it passed.

    The exit code is the verdict: 0 if every stage passed, 1 if a limit or criterion was not met, otherwise the reason
    why a stage was not done. Called again with the same --job, the command continues where that job ended; what is
    done and still holds is not repeated. Ctrl-C, a signal or a deadline is not an emergency stop.

    Example: catseye campaign scara-day --cell cell.toml --job night-12 --deadline 06:30 --json
    """
    if file is None:
        _list_shipped(as_json=as_json)
        return
    from catseye.app.campaign.load import load_campaign
    from catseye.app.cli.campaigning import Wanted
    from catseye.app.service.metrics import require_metrics_file

    if cell is None:
        raise UsageError(f"--cell is missing: catseye campaign {file} --cell CELL")
    require_metrics_file(metrics, file, cell, answers)
    wanted = Wanted(
        load_campaign(file),
        cell,
        runs_folder(runs),
        job,
        deadline,
        wait_lock,
        answers,
        arm,
        speed,
        waive_walk,
        as_json,
        metrics,
    )
    if dry_run:
        _plan(wanted)
    else:
        _conduct(wanted)


def _list_shipped(*, as_json: bool) -> None:
    from catseye.app.campaign.load import shipped
    from catseye.app.cli.documents import ShippedCampaign

    for name, path in shipped().items():
        if as_json:
            write_document("campaign-file", ShippedCampaign(name=name, path=str(path)).json_object())
        else:
            write_line(f"{name}  {path}")
    if not as_json:
        note("copy one, edit it, and give it as FILE: catseye campaign FILE --cell CELL")


def _plan(wanted: "Wanted") -> None:
    """Say what would be done."""
    from catseye.app.cli.campaign_plan import campaign_plan, plan_report
    from catseye.app.cli.report_output import note_statements, write_tables

    plan = campaign_plan(wanted, datetime.now(UTC))
    if wanted.as_json:
        write_document("campaign-plan", plan.json_object())
        return
    report = plan_report(plan)
    write_tables(report)
    note_statements(report)


def _conduct(wanted: "Wanted") -> NoReturn:
    """Lead a job through its stages, and end with its verdict."""
    from catseye.app.campaign.report import campaign_report
    from catseye.app.cli.campaigning import conduct_campaign
    from catseye.app.cli.outlet import patient_output
    from catseye.app.cli.report_output import note_statements, write_tables

    with patient_output():
        verdict = asyncio.run(conduct_campaign(wanted, datetime.now(UTC)))
    if not wanted.as_json:
        report = campaign_report(verdict)
        # The exit code is the verdict, also where nobody reads it.
        with suppress(OSError):
            write_tables(report)
        with suppress(OSError):
            note_statements(report)
    sys.exit(verdict.exit_code)
