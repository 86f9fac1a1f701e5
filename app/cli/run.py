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
    str, typer.Argument(help="see: catseye procedures", autocompletion=completion.procedures)
]
Params = Annotated[
    list[str] | None,
    typer.Option(metavar="K=V", help="parameter; may be repeated", autocompletion=completion.parameters),
]
Search = Annotated[
    str,
    typer.Option(
        help="aim: auto (newest search of this cell), none, or a run", autocompletion=completion.aims
    ),
]
Walk = Annotated[
    bool,
    typer.Option(
        "--walk", help="walk its motions through: slowly, nothing measured, while the space bar is held"
    ),
]
Detach = Annotated[bool, typer.Option("--detach", help="let it run on by itself; catseye attach joins it")]


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
    runs: Runs = None,
    as_json: AsJson = False,
    telemetry: Telemetry = False,
) -> None:
    """Run a procedure headless. Ctrl-C: once holds, twice stops, three times aborts. This is no emergency stop.

    With --walk the arm moves while the space bar is held and stops when it is let go. That is no enabling device.

    Example: catseye run open-loop --cell cell.toml --dry-run;
    catseye run validation-path --cell cell.toml --param path=path.toml
    """
    from catseye.app.cell.load import load_cell
    from catseye.app.cli.drive import conduct
    from catseye.app.cli.hosting import DriveOptions
    from catseye.app.protocol.procedures import load_procedure, parse_params
    from catseye.app.service.planned_walk import as_walk
    from catseye.app.service.running import plan_run

    if detach and walk:
        raise UsageError("a walk needs somebody at its keys: leave --detach out")
    if walk and dry_run:
        raise UsageError("--walk drives the plan and --dry-run touches no device: leave one of them out")
    options = DriveOptions(answers, arm, speed, keep_drives, waive_walk, as_json, telemetry)
    root = runs_folder(runs)
    if detach and not dry_run:
        _detach(procedure, cell, param or [], search, options, root)
    loaded, runnable = load_cell(cell), load_procedure(procedure)
    params = parse_params(runnable.params_type, param or [])
    planned = plan_run(loaded, runnable, params, root, search)
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
    detach(request, cell, root, as_json=options.as_json)
