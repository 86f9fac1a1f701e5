"""runs: the list of stored runs."""

from typing import TYPE_CHECKING

from catseye.app.cli.options import AsJson, Runs
from catseye.app.cli.output import note, table, write_json, write_line

if TYPE_CHECKING:
    from catseye.app.store.catalog import RunSummary


def runs(runs: Runs = None, as_json: AsJson = False) -> None:
    """List the stored runs, oldest first."""
    from catseye.app.store.catalog import list_runs
    from catseye.app.store.runs_folder import runs_folder

    root = runs_folder(runs)
    summaries = list_runs(root)
    if as_json:
        for run in summaries:
            write_json(_facts(run))
    elif summaries:
        rows = [[run.id, run.started, run.procedure, run.status, _to_go_on(run)] for run in summaries]
        write_line(table(["id", "started", "procedure", "status", "to go on"], rows))
    else:
        note(f"no runs in {root}; start one with: catseye run PROCEDURE --cell FILE")


def _facts(run: "RunSummary") -> dict[str, object]:
    return {
        "run": run.name,
        "id": run.id,
        "procedure": run.procedure,
        "started": run.started,
        "status": run.status,
        "path": str(run.path),
        "resumable": _resumable(run),
    }


def _to_go_on(run: "RunSummary") -> str:
    return f"catseye resume {run.id}" if _resumable(run) else ""


def _resumable(run: "RunSummary") -> bool:
    from catseye.app.errors import StorageError
    from catseye.app.store.reader import Accept, RunReader
    from catseye.app.store.resumable import why_not_resumable

    if run.status in {"complete", "running", "damaged"}:
        return False
    try:
        return not why_not_resumable(RunReader(run.path, Accept.UNCHECKED))
    except StorageError:
        # The others are listed all the same; whoever opens it learns why.
        return False
