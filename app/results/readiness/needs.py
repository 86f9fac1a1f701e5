"""What a procedure needs on a cell, whether that is met, and what to do when it is not."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from pydantic import ValidationError

from catseye.app.cell.bench import bench_for
from catseye.app.cell.model import Cell
from catseye.app.errors import ConfigError, StorageError, UsageError
from catseye.app.protocol.procedures import Runnable
from catseye.app.results.numbers import age_text
from catseye.app.results.readiness.cell_runs import CellRun, CellRuns
from catseye.app.results.readiness.need import Need
from catseye.app.store.basis import find_aim
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.errors import ProcedureError
from catseye.procedures.kit.needs import After
from catseye.procedures.scara.bench import ScaraBench

SEARCH: Final = "reflector-search"


@dataclass(frozen=True)
class FoundAim:
    """What a run would be aimed with.

    Attributes:
        bench: aimed; as the cell file has it where there is nothing better.
        need: what is to be said about it.
        search: the run that found it; None without one.
    """

    bench: Bench
    need: Need
    search: CellRun | None


def needs_of(procedure: Runnable, cell: Cell, bench: Bench, aim: FoundAim, runs: CellRuns) -> list[Need]:
    """Return what a procedure needs on a cell.

    Args:
        procedure: which.
        cell: which.
        bench: as the cell file describes it.
        aim: what it would be aimed with.
        runs: of this cell.
    """
    declared = procedure.needs
    try:
        bench_for(cell, declared.bench, procedure.name)
    except ConfigError as error:
        return [Need("cell file", "missing", str(error))]
    needs = [*_reflectors(bench), *(_earlier(after, runs) for after in declared.after)]
    if declared.aim:
        needs.append(aim.need)
    if declared.tracker:
        needs.append(_tracker(bench))
    needs.append(_plan(procedure, aim.bench if declared.aim else bench))
    return needs


def aim_of(bench: Bench, root: Path, runs: CellRuns) -> FoundAim:
    """Return the aim that a run would be planned with, and what is to be said about it."""
    try:
        aim = find_aim(bench, root)
    except (UsageError, StorageError) as error:
        return FoundAim(bench, Need("search", "missing", str(error)), None)
    run = runs.named(aim.source)
    if run is None:
        return FoundAim(aim.bench, Need("search", "advised", f"rough places only; run {SEARCH}"), None)
    return FoundAim(aim.bench, Need("search", "met", f"run {run.id}, {age_text(run.age_s)}"), run)


def _reflectors(bench: Bench) -> list[Need]:
    if not isinstance(bench, ScaraBench):
        return []
    names = [reflector.name for reflector in bench.reflectors]
    one = ", one cat's eye that is carried from nest to nest" if bench.optics.one_reflector else ""
    return [Need("reflectors", "met", f"{', '.join(names)}{one}")]


def _earlier(after: After, runs: CellRuns) -> Need:
    """Return whether a procedure that should have been run was, and lately enough."""
    run, limit_s = runs.last_counting(after), after.fresh_for_s
    if run is not None:
        return Need(after.what, "met", f"run {run.id}, {age_text(run.age_s)}")
    lately = "on this cell" if limit_s is None else f"in {limit_s / 3600:g} h"
    return Need(after.what, "advised", f"none {lately}; run {after.procedure}")


def _tracker(bench: Bench) -> Need:
    if bench.tracker:
        return Need("tracker", "met", "in the cell file")
    return Need("tracker", "advised", "none: the interferometer measures, or instrument = file")


def _plan(procedure: Runnable, bench: Bench) -> Need:
    try:
        procedure.plan(bench, procedure.params_type())
    except ProcedureError as error:
        return Need("plan", "missing", str(error))
    except ValidationError:
        return Need("plan", "advised", "it has parameters that have to be given")
    return Need("plan", "met", "limits hold with default parameters")
