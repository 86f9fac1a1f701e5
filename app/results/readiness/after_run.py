"""What is sensible after a run has ended."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import Final, Literal

from catseye.app.protocol.procedures import declared_by
from catseye.app.results.readiness.run_files import NO_FILES, RunFiles, cell_of_run
from catseye.app.results.stored_results import results_in, stored_result
from catseye.procedures.kit.procedure import Analysis, Asked

Kind = Literal["analyse", "validate", "report", "compensate", "trend", "resume", "clear", "next"]

_VALIDATE: Final = "validate"
_COMPENSATE: Final = "compensate"
_SEVERAL: Final = 2


@dataclass(frozen=True)
class Advice:
    """One thing that can be done.

    Attributes:
        kind: which.
        text: what it is good for.
        command: words of `catseye` without the file that is written; empty where it is no command.
        writes: that file, if its name is free; None where nothing is written.
        asks: what only a person knows; `{name}` stands for it among the words.
        shows: a file that is there already, and that this shows.
    """

    kind: Kind
    text: str
    command: tuple[str, ...] = ()
    writes: Path | None = None
    asks: tuple[Asked, ...] = ()
    shows: Path | None = None

    @property
    def name(self) -> str:
        """What it is called."""
        return self.command[0] if self.kind == "analyse" else self.kind


CLEAR = Advice("clear", "when the cause is found and removed")
"""Comes first after an abort, also where no run was: nothing begins before."""

NEXT = Advice("next", "what comes next: n on Procedures opens it")


def after_run(
    procedure: str,
    status: str,
    run: str,
    root: Path,
    result: Path | None = None,
    files: RunFiles = NO_FILES,
    cell: Path | None = None,
    *,
    rejected: bool = False,
) -> list[Advice]:
    """Return what is sensible, the most sensible first.

    Results and reports go beside the folder of runs: a run's own folder is sealed.

    Args:
        status: complete, stopped, aborted or failed.
        result: that the run shows the worth of, as `result_to_validate` finds it.
        files: what was made of the run before.
        cell: cell file of the bench; None where there is none.
        rejected: what the run has stored is no use, and it never goes on.
    """
    folder, run_id, runs = root.absolute().parent, run.rpartition("_")[2], ("--runs", str(root))
    page = folder / f"report-{run_id}.html"
    report = Advice("report", "one page about this run", ("report", run, *runs), page)
    if rejected:
        return [report]
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
    more = [
        *_compensating(files.result or result, run_id, folder, files, cell),
        *_trend(root, run_id, folder, files, cell),
    ]
    return [*does, report, *more, NEXT] if does else [NEXT, report, *more]


def _compensating(
    result: Path | None, run_id: str, folder: Path, files: RunFiles, cell: Path | None
) -> list[Advice]:
    """Return that commands can be corrected by a result, or that they are."""
    if files.compensation is not None:
        return [Advice("compensate", f"shows {files.compensation.name}", shows=files.compensation)]
    if result is None or cell is None:
        return []
    stored = stored_result(result)
    procedures = {_procedure_of(source) for source in (() if stored is None else stored.runs)}
    for analysis in (each for procedure in procedures for each in _analyses(procedure)):
        if analysis.command == _COMPENSATE:
            known = {"{result}": str(result), "{cell}": str(cell)}
            words = takewhile(lambda word: word != "-o", analysis.usage)
            command = (_COMPENSATE, *(known.get(word, word) for word in words))
            text, file = f"commands corrected by {result.name}", folder / f"compensated-{run_id}.csv"
            return [Advice("compensate", text, command, file, analysis.asks)]
    return []


def _trend(root: Path, run_id: str, folder: Path, files: RunFiles, cell: Path | None) -> list[Advice]:
    """Return that the results of an arm can be held against each other, where there are several."""
    if files.results_of_arm < _SEVERAL or cell is None:
        return []
    text = f"one page: {files.results_of_arm} results of this arm over time"
    command = ("trend", str(cell), "--runs", str(root))
    return [Advice("trend", text, command, folder / f"trend-{run_id}.html")]


def validation(result: Path, run: str, root: Path) -> tuple[str, ...]:
    """Return the words of the command that holds a result against a run."""
    return (_VALIDATE, str(result), "--measured", run, "--runs", str(root))


def result_to_validate(run: str, procedure: str, root: Path) -> Path | None:
    """Return the newest result of a run's cell, beside the runs, that it shows the worth of; None without one.

    It reads files: call it in a thread.
    """
    if all(each.command != _VALIDATE for each in _analyses(procedure)):
        return None
    way, cell = _way_of(procedure), cell_of_run(root / run)
    of_the_way = {
        path
        for source, path in results_in([root.absolute().parent]).items()
        if _way_of(_procedure_of(source)) == way and cell_of_run(root / source) == cell
    }
    return max(of_the_way, key=lambda path: path.stat().st_mtime, default=None)


def _analyses(procedure: str) -> Sequence[Analysis]:
    declared = declared_by(procedure)
    return () if declared is None else declared.analyses


def _way_of(procedure: str) -> str:
    declared = declared_by(procedure)
    return "" if declared is None or declared.stage is None else declared.stage.way


def _procedure_of(run: str) -> str:
    return run.partition("_")[2].rpartition("_")[0]
