"""run: a procedure, headless."""

import asyncio
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from catseye.app.cell.load import load_cell
from catseye.app.cli.detached_engine import detach
from catseye.app.cli.drive import DriveOptions
from catseye.app.cli.hosting import serve_and_run
from catseye.app.cli.output import emit, say
from catseye.app.cli.rehearsal import tell_rehearsal
from catseye.app.engine.heap import settled_heap
from catseye.app.errors import UsageError
from catseye.app.procedure_list import load_procedure, parse_params
from catseye.app.running import PlannedRun, plan_run, rehearse
from catseye.app.runs_folder import runs_folder
from catseye.app.walk.planning import as_walk
from catseye.procedures.kit.context import Json


@dataclass(frozen=True)
class Asked:
    """What is to be run.

    Attributes:
        procedure: name.
        cell: cell file.
        params: as key=value.
        search: where the aim comes from.
    """

    procedure: str
    cell: Path
    params: list[str]
    search: str


def run_command(asked: Asked, options: DriveOptions, runs: Path | None, *, dry_run: bool, walk: bool) -> None:
    """Plan, then rehearse, walk or run."""
    if walk and dry_run:
        raise UsageError("--walk drives the plan and --dry-run touches no device: leave one of them out")
    loaded, runnable, root = load_cell(asked.cell), load_procedure(asked.procedure), runs_folder(runs)
    params = parse_params(runnable.params_type, asked.params)
    planned = plan_run(loaded, runnable, params, root, asked.search)
    if runnable.needs_aim:
        say(f"aim from {planned.aim}")
    conduct(as_walk(planned, root) if walk else planned, root, options, dry_run=dry_run)


def detached_command(asked: Asked, options: DriveOptions, runs: Path | None) -> NoReturn:
    """Let an engine of its own plan and run; end when it has begun."""
    texts: list[Json] = [*asked.params]
    request: dict[str, Json] = {
        "op": "start",
        "procedure": asked.procedure,
        "params": texts,
        "search": asked.search,
        "arm": options.arm,
        "speed": options.speed,
        "keep_drives": options.keep_drives,
        "answers": None if options.answers is None else str(options.answers.resolve()),
        "waive_walk": options.waive_walk,
    }
    detach(request, asked.cell, runs_folder(runs), as_json=options.as_json)


def conduct(planned: PlannedRun, root: Path, options: DriveOptions, *, dry_run: bool) -> None:
    """Rehearse a plan, or run it and end the process with the run's exit code."""
    if dry_run:
        tell_rehearsal(planned, asyncio.run(rehearse(planned)), as_json=options.as_json)
        say("a real arm drives this where it was walked through (--walk), or with a reason (--waive-walk)")
        return
    with settled_heap():
        outcome = asyncio.run(serve_and_run(planned, root, options))
    if not options.as_json:
        emit(str(outcome.path))
    sys.exit(int(outcome.exit_code))
