"""run: a procedure, headless."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from catseye.app.cli import completion
from catseye.app.cli.options import (
    Answers,
    Arm,
    AsJson,
    CellOption,
    DryRun,
    KeepDrives,
    Metrics,
    Runs,
    Speed,
    Telemetry,
    WaiveWalk,
)
from catseye.app.cli.output import note
from catseye.app.errors import UsageError
from catseye.app.store.runs_folder import runs_folder

if TYPE_CHECKING:
    from catseye.app.cli.hosting import DriveOptions

ProcedureName = Annotated[
    str,
    typer.Argument(
        help="name of the procedure; catseye procedures lists them", autocompletion=completion.procedures
    ),
]
Params = Annotated[
    list[str] | None,
    typer.Option(
        metavar="K=V",
        help="parameter of the procedure; may be repeated",
        autocompletion=completion.parameters,
    ),
]
Search = Annotated[
    str,
    typer.Option(
        help="search to take the aim from: auto (newest of this cell), none, or a run",
        autocompletion=completion.aims,
    ),
]
Walk = Annotated[
    bool,
    typer.Option(
        "--walk",
        help="walk-through: drive the motions slowly, without measuring, while you hold the space bar",
    ),
]
Job = Annotated[
    str,
    typer.Option("--job", metavar="ID", help="job that the run belongs to; set by catseye campaign"),
]
Detach = Annotated[bool, typer.Option("--detach", help="run in the background; catseye attach joins the run")]


def run(
    procedure: ProcedureName,
    cell: CellOption,
    param: Params = None,
    search: Search = "auto",
    answers: Answers = None,
    arm: Arm = None,
    speed: Speed = 1.0,
    keep_drives: KeepDrives = False,
    dry_run: DryRun = False,
    walk: Walk = False,
    waive_walk: WaiveWalk = None,
    detach: Detach = False,
    job: Job = "",
    runs: Runs = None,
    as_json: AsJson = False,
    telemetry: Telemetry = False,
    metrics: Metrics = None,
) -> None:
    """Run a procedure. Ctrl-C holds, a second stops, a third aborts; it is not an emergency stop.

    With --walk the arm moves while you hold the space bar, and stops when you let go. The space bar is not an
    enabling device.

    Example: catseye run open-loop --cell cell.toml --dry-run;
    catseye run validation-path --cell cell.toml --param path=path.toml
    """
    from catseye.app.cell.load import load_cell
    from catseye.app.cli.drive import conduct
    from catseye.app.cli.hosting import DriveOptions
    from catseye.app.protocol.procedures import load_procedure, parse_params
    from catseye.app.service.metrics import require_metrics_file
    from catseye.app.service.planned_walk import as_walk
    from catseye.app.service.running import plan_run

    require_metrics_file(metrics, cell, answers)
    if detach and walk:
        raise UsageError("a walk needs somebody at its keys: leave --detach out")
    if walk and dry_run:
        raise UsageError("--walk drives the plan and --dry-run touches no device: leave one of them out")
    options = DriveOptions(answers, arm, speed, keep_drives, waive_walk, as_json, telemetry, metrics)
    root = runs_folder(runs)
    if detach and not dry_run:
        _detach(procedure, cell, param or [], search, options, root)
    loaded, runnable = load_cell(cell), load_procedure(procedure)
    params = parse_params(runnable.params_type, param or [])
    planned = plan_run(loaded, runnable, params, root, search, job)
    if runnable.needs.basis is not None:
        note(f"aim from {planned.aim}")
    conduct(as_walk(planned, root) if walk else planned, root, options, dry_run=dry_run)


def _detach(
    procedure: str, cell: Path, params: list[str], search: str, options: "DriveOptions", root: Path
) -> NoReturn:
    """Let an engine of its own plan and run; end when it has begun."""
    from catseye.app.cli.detached_engine import detach
    from catseye.app.protocol.requests import Start

    request = Start(
        procedure=procedure,
        params=params,
        search=search,
        arm=options.arm,
        speed=1.0 if options.speed is None else options.speed,
        keep_drives=options.keep_drives,
        answers=None if options.answers is None else str(options.answers.resolve()),
        waive_walk=options.waive_walk,
    )
    detach(request, cell, root, as_json=options.as_json, metrics=options.metrics)
