"""resume: an interrupted run goes on where it stopped."""

import os
from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import (
    Answers,
    Arm,
    AsJson,
    DryRun,
    KeepDrives,
    Metrics,
    Runs,
    StoredRun,
    Telemetry,
    WaiveWalk,
)
from catseye.app.cli.output import note, write_document
from catseye.app.store.runs_folder import runs_folder
from catseye.drivers.roles.clock import SystemClock


def resume(
    run: StoredRun,
    cell: Annotated[
        Path | None, typer.Option(metavar="FILE", help="cell file with changed endpoints or time-outs")
    ] = None,
    answers: Answers = None,
    arm: Arm = None,
    speed: Annotated[
        float | None,
        typer.Option(min=0.001, max=1e6, help="bench seconds per real second; emulators only [as before]"),
    ] = None,
    keep_drives: KeepDrives = False,
    dry_run: DryRun = False,
    waive_walk: WaiveWalk = None,
    runs: Runs = None,
    as_json: AsJson = False,
    telemetry: Telemetry = False,
    metrics: Metrics = None,
) -> None:
    """Continue an interrupted run. Completed steps are not repeated.

    The run contains all that is needed. Before it goes on, it asks what may have changed meanwhile.

    Example: catseye resume 1a2b3c
    """
    from catseye.app.cell.load import load_cell
    from catseye.app.cli.drive import conduct
    from catseye.app.cli.going_on import ended_late
    from catseye.app.cli.hosting import DriveOptions
    from catseye.app.files import crash_points
    from catseye.app.service.metrics import require_metrics_file
    from catseye.app.service.resumption import plan_resume
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.mend import seal_late
    from catseye.app.store.reader import RunReader

    require_metrics_file(metrics, answers)
    crash_points.arm(os.environ)
    root = runs_folder(runs)
    path = resolve_run(root, run)
    if not dry_run and seal_late(path, SystemClock().now_utc().isoformat()):
        note(f"{path.name} was complete and not yet sealed: its manifest is written now")
        if as_json:
            write_document("events", ended_late(path).json_object())
        return
    planned = plan_resume(root, run, None if cell is None else load_cell(cell))
    reader = RunReader(path)
    aim = "" if planned.procedure.needs.basis is None else f"; aim from {planned.aim}"
    note(f"{path.name} {reader.status}; {reader.count('steps')} steps are done and stay{aim}")
    options = DriveOptions(answers, arm, speed, keep_drives, waive_walk, as_json, telemetry, metrics)
    conduct(planned, root, options, dry_run=dry_run)
