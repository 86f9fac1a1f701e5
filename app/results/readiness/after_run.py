"""What is sensible after a run has ended."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from catseye.app.errors import StorageError
from catseye.app.protocol.procedures import declared_by
from catseye.app.results.stored_results import results_in
from catseye.app.store.reader import Accept, RunReader
from catseye.procedures.kit.procedure import Analysis

Kind = Literal["analyse", "validate", "report", "resume", "clear", "next"]

_VALIDATE: Final = "validate"


@dataclass(frozen=True)
class Advice:
    """One thing that can be done.

    Attributes:
        kind: which.
        text: what it is good for.
        command: words of `catseye` without the file that is written; empty where it is no command.
        writes: that file, if its name is free; None where nothing is written.
    """

    kind: Kind
    text: str
    command: tuple[str, ...] = ()
    writes: Path | None = None

    @property
    def name(self) -> str:
        """What it is called."""
        return self.command[0] if self.kind == "analyse" else self.kind


CLEAR = Advice("clear", "when the cause is found and removed")
"""Comes first after an abort, also where no run was: nothing begins before."""

NEXT = Advice("next", "what comes next: n on Procedures opens it")


def after_run(procedure: str, status: str, run: str, root: Path, result: Path | None = None) -> list[Advice]:
    """Return what is sensible, the most sensible first.

    Results and reports go beside the folder of runs: a run's own folder is sealed.

    Args:
        status: complete, stopped, aborted or failed.
        result: that the run shows the worth of, as `result_to_validate` finds it.
    """
    folder, run_id, runs = root.absolute().parent, run.rpartition("_")[2], ("--runs", str(root))
    page = folder / f"report-{run_id}.html"
    report = Advice("report", "one page about this run", ("report", run, *runs), page)
    if status != "complete":
        return [Advice("resume", f"continue it with: catseye resume {run_id}", ("resume", run)), report]
    file = folder / f"result-{run_id}.json"
    does = [
        Advice("analyse", each.gives, (each.command, run, *runs), file)
        for each in _analyses(procedure)
        if each.writes_result
    ]
    if result is not None:
        validated = folder / f"validation-{run_id}.html"
        text = f"one page: what {result.name} leaves"
        does.append(Advice("validate", text, validation(result, run, root), validated))
    return [*does, report, NEXT] if does else [NEXT, report]


def validation(result: Path, run: str, root: Path) -> tuple[str, ...]:
    """Return the words of the command that holds a result against a run."""
    return (_VALIDATE, str(result), "--measured", run, "--runs", str(root))


def result_to_validate(run: str, procedure: str, root: Path) -> Path | None:
    """Return the newest result of a run's cell, beside the runs, that it shows the worth of; None without one.

    It reads files: call it in a thread.
    """
    if all(each.command != _VALIDATE for each in _analyses(procedure)):
        return None
    way, cell = _way_of(procedure), _cell_of(root / run)
    of_the_way = {
        path
        for source, path in results_in([root.absolute().parent]).items()
        if _way_of(_procedure_of(source)) == way and _cell_of(root / source) == cell
    }
    return max(of_the_way, key=lambda path: path.stat().st_mtime, default=None)


def _analyses(procedure: str) -> Sequence[Analysis]:
    declared = declared_by(procedure)
    return () if declared is None else declared.analyses


def _way_of(procedure: str) -> str:
    declared = declared_by(procedure)
    return "" if declared is None or declared.stage is None else declared.stage.way


def _cell_of(run: Path) -> object:
    """Return the name of a run's cell; None of one that cannot be read."""
    try:
        return RunReader(run, Accept.UNCHECKED).meta.get("cell")
    except StorageError:
        return None


def _procedure_of(run: str) -> str:
    return run.partition("_")[2].rpartition("_")[0]
