"""What earlier runs have left a bench like, as a procedure declares that it matters."""

from pathlib import Path

from catseye.app.store.catalog import list_runs
from catseye.app.store.reader import Accept, RunReader
from catseye.procedures.kit.needs import Aftermath


def find_aftermath(aftermath: Aftermath | None, cell: str, root: Path) -> str:
    """Return which run of a cell has left what; empty where none has, or where it is settled."""
    if aftermath is None:
        return ""
    for run in reversed(list_runs(root)):
        if run.procedure not in {aftermath.procedure, aftermath.settled_by} or run.status == "damaged":
            continue
        # What was changed since can only be named wrongly: nothing is planned from it.
        reader = RunReader(run.path, Accept.UNCHECKED)
        if reader.meta.get("cell") != cell:
            continue
        if run.procedure == aftermath.settled_by and run.status == "complete":
            return ""
        if run.procedure == aftermath.procedure and (text := aftermath.left(reader)):
            return f"{run.name} {text}"
    return ""
