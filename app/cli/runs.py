"""runs: the list of stored runs, and keeping house among them."""

import re
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Annotated, Final

import typer

from catseye.app.cli.options import AsJson, Runs
from catseye.app.cli.output import note, write_document, write_line
from catseye.app.cli.report_output import write_tables
from catseye.app.errors import UsageError
from catseye.app.store.runs_folder import runs_folder

_AGE: Final = re.compile(r"(\d+)([dhw])")
_UNIT_H: Final = {"h": 1, "d": 24, "w": 168}

runs = typer.Typer(
    help="List the stored runs, oldest first; prune and keep them.",
    add_completion=False,
    rich_markup_mode=None,
)


@runs.callback(invoke_without_command=True)
def list_all(ctx: typer.Context, runs: Runs = None, as_json: AsJson = False) -> None:
    """List the stored runs, oldest first; prune and keep them."""
    from catseye.app.results.runs.documents import run_entry
    from catseye.app.results.runs.reports import list_report
    from catseye.app.store.catalog import list_runs

    if ctx.invoked_subcommand is not None:
        if runs is not None or as_json:
            # Taken here they would be lost, and prune would remove runs of another folder.
            raise UsageError(f"give --runs and --json after {ctx.invoked_subcommand}, not before it")
        return
    root = runs_folder(runs)
    entries = list(map(run_entry, list_runs(root)))
    if as_json:
        for entry in entries:
            write_document("run-entry", entry.model_dump(mode="json"))
    elif entries:
        write_tables(list_report(entries))
    else:
        note(f"no runs in {root}; start one with: catseye run PROCEDURE --cell FILE")


@runs.command()
def prune(
    older_than: Annotated[
        str,
        typer.Option("--older-than", metavar="AGE", help="remove runs that began longer ago: 90d, 12w, 36h"),
    ],
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="say what would be removed, and remove nothing")
    ] = False,
    unfinished: Annotated[
        bool, typer.Option("--unfinished", help="also remove old runs that stopped and could be resumed")
    ] = False,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Remove old runs. Unsealed, resumable and kept runs (catseye runs keep) stay, and so does a run under way.

    Example: catseye runs prune --older-than 90d --dry-run
    """
    from catseye.app.cli.documents import PrunedRun
    from catseye.app.store.prune import finish_removing, old_runs, remove

    root = runs_folder(runs)
    age = _age(older_than)
    if not dry_run:
        finish_removing(root)
    freed = 0
    for one in old_runs(root, age, datetime.now(UTC), unfinished=unfinished):
        why_not = one.why_not or ("" if dry_run else remove(one.path, unfinished=unfinished))
        freed += 0 if why_not else one.bytes
        removed = not why_not and not dry_run
        entry = PrunedRun(run=one.path.name, bytes=one.bytes, removed=removed, why_not=why_not)
        if as_json:
            write_document("pruned-run", entry.json_object())
        else:
            said = why_not or ("would be removed" if dry_run else "removed")
            write_line(f"{one.path.name}  {one.bytes / 1e6:.1f} MB  {said}")
    note(f"{freed / 1e6:.1f} MB {'would be' if dry_run else 'are'} freed in {root}")


@runs.command()
def keep(
    what: Annotated[str, typer.Argument(metavar="RUN|RESULT", help="run, or result whose runs are kept")],
    off: Annotated[
        bool, typer.Option("--off", help="release the runs, so that prune may remove them")
    ] = False,
    runs: Runs = None,
) -> None:
    """Keep runs for ever, such as those of a baseline. Prune leaves them alone.

    Example: catseye runs keep baseline.json
    """
    from catseye.app.results.stored_results import stored_result
    from catseye.app.store import prune as house
    from catseye.app.store.catalog import resolve_run

    root = runs_folder(runs)
    result = stored_result(Path(what)) if what.endswith(".json") else None
    if what.endswith(".json") and result is None:
        raise UsageError(f"{what}: is no result, or cannot be read")
    names = [resolve_run(root, what).name] if result is None else list(result.runs)
    if off:
        house.release(root, names)
    else:
        house.keep(root, names, f"runs of {what}" if result is not None else "somebody asked for it")
    note(f"{', '.join(names)}: {'kept no longer' if off else 'kept'}")


def _age(text: str) -> timedelta:
    found = _AGE.fullmatch(text.strip())
    if found is None:
        raise UsageError(f"--older-than {text!r} is no age: give days, weeks or hours, as 90d, 12w or 36h")
    try:
        return timedelta(hours=int(found[1]) * _UNIT_H[found[2]])
    except OverflowError:
        raise UsageError(
            f"--older-than {text!r} lies before the calendar: give fewer days, weeks or hours"
        ) from None
