"""resume: an interrupted run goes on where it stopped."""

import os
from pathlib import Path

from catseye.app.cell.load import load_cell
from catseye.app.cli.drive import DriveOptions
from catseye.app.cli.output import say
from catseye.app.cli.run import conduct
from catseye.app.engine.crash_points import arm as arm_crash_point
from catseye.app.resuming import plan_resume
from catseye.app.runs_folder import runs_folder
from catseye.app.store.catalog import resolve_run
from catseye.app.store.mend import seal_late
from catseye.app.store.reader import RunReader
from catseye.drivers.roles.clock import SystemClock


def resume_command(
    run: str, cell: Path | None, options: DriveOptions, runs: Path | None, *, dry_run: bool
) -> None:
    """Plan the rest of a run from what it has stored, then rehearse or do it."""
    arm_crash_point(os.environ)
    root = runs_folder(runs)
    path = resolve_run(root, run)
    if not dry_run and seal_late(path, SystemClock().now_utc().isoformat()):
        say(f"{path.name} was complete and not yet sealed: its manifest is written now")
        return
    planned = plan_resume(root, run, None if cell is None else load_cell(cell))
    reader = RunReader(path)
    say(
        f"{path.name} {reader.status}; {reader.count('steps')} steps are done and stay; aim from {planned.aim}"
    )
    conduct(planned, root, options, dry_run=dry_run)
