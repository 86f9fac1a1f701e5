"""run: a procedure, headless."""

import asyncio
import sys
from pathlib import Path
from typing import NoReturn

from app.cell.load import load_cell
from app.commands.engine import detach
from app.commands.hosting import serve_and_run
from app.commands.output import emit, say
from app.commands.rehearsal import tell_rehearsal
from app.engine.heap import settled_heap
from app.errors import UsageError
from app.procedure_list import load_procedure, parse_params
from app.running import PlannedRun, plan_run, rehearse
from app.runs_folder import runs_folder
from app.walk.planning import as_walk
from procedures.context import Json


def run_command(
    procedure: str,
    cell: Path,
    param: list[str],
    search: str,
    answers: Path | None,
    arm: str | None,
    speed: float,
    keep_drives: bool,
    dry_run: bool,
    walk: bool,
    waive_walk: str | None,
    runs: Path | None,
    as_json: bool,
) -> None:
    """Plan, then rehearse, walk or run."""
    if walk and dry_run:
        raise UsageError("--walk drives the plan and --dry-run touches no device: leave one of them out")
    loaded, runnable, root = load_cell(cell), load_procedure(procedure), runs_folder(runs)
    params = parse_params(runnable.params_type, param)
    planned = plan_run(loaded, runnable, params, root, search)
    if runnable.needs_aim:
        say(f"aim from {planned.aim}")
    if walk:
        planned = as_walk(planned, root)
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


def detached_command(
    procedure: str,
    cell: Path,
    param: list[str],
    search: str,
    answers: Path | None,
    arm: str | None,
    speed: float,
    keep_drives: bool,
    waive_walk: str | None,
    runs: Path | None,
    as_json: bool,
) -> NoReturn:
    """Let an engine of its own plan and run; end when it has begun."""
    texts: list[Json] = [*param]
    request: dict[str, Json] = {
        "op": "start",
        "procedure": procedure,
        "params": texts,
        "search": search,
        "arm": arm,
        "speed": speed,
        "keep_drives": keep_drives,
        "answers": None if answers is None else str(answers.resolve()),
        "waive_walk": waive_walk,
    }
    detach(request, cell, runs_folder(runs), as_json=as_json)


def conduct(
    planned: PlannedRun,
    root: Path,
    answers: Path | None,
    arm: str | None,
    speed: float,
    waive_walk: str | None,
    *,
    keep_drives: bool,
    dry_run: bool,
    as_json: bool,
) -> None:
    """Rehearse a plan, or run it and end the process with the run's exit code."""
    if dry_run:
        tell_rehearsal(planned, asyncio.run(rehearse(planned)), as_json=as_json)
        say("a real arm drives this where it was walked through (--walk), or with a reason (--waive-walk)")
        return
    with settled_heap():
        outcome = asyncio.run(
            serve_and_run(
                planned, root, answers, arm, speed, waive_walk, keep_drives=keep_drives, as_json=as_json
            )
        )
    if not as_json:
        emit(str(outcome.path))
    sys.exit(int(outcome.exit_code))
