"""resume: an interrupted run goes on where it stopped."""

import os
from pathlib import Path

from app.cell.load import load_cell
from app.commands.output import say
from app.commands.run import conduct
from app.engine.crash_points import arm as arm_crash_point
from app.resuming import plan_resume
from app.runs_folder import runs_folder
from app.store.catalog import resolve_run
from app.store.mend import seal_late
from app.store.reader import RunReader
from drivers.clock import SystemClock


def resume_command(
    run: str,
    cell: Path | None,
    answers: Path | None,
    arm: str | None,
    speed: float | None,
    keep_drives: bool,
    dry_run: bool,
    waive_walk: str | None,
    runs: Path | None,
    as_json: bool,
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
    speed = planned.clock_speed if speed is None else speed
    conduct(
        planned,
        root,
        answers,
        arm,
        speed,
        waive_walk,
        keep_drives=keep_drives,
        dry_run=dry_run,
        as_json=as_json,
    )
