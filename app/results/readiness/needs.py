"""What a procedure needs on a cell, whether that is met, and what to do when it is not."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from catseye.app.cell.bench import bench_for
from catseye.app.cell.model import Cell
from catseye.app.errors import ConfigError, StorageError, UsageError
from catseye.app.results.numbers import age_text
from catseye.app.results.readiness.cell_runs import CellRun, CellRuns
from catseye.app.results.readiness.need import Need
from catseye.app.store.basis import find_basis
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.errors import ProcedureError
from catseye.procedures.kit.needs import After, Basis, Equipment
from catseye.procedures.kit.procedure import Procedure


@dataclass(frozen=True)
class CellBasis:
    """What runs of a cell would be planned from.

    Attributes:
        bench: with what was found; as the cell file has it where there is nothing better.
        need: what is to be said about it.
        run: that found it; None without one.
    """

    bench: Bench
    need: Need
    run: CellRun | None


def needs_of(
    procedure: Procedure, cell: Cell, bench: Bench, bases: Mapping[Basis, CellBasis], runs: CellRuns
) -> list[Need]:
    """Return what a procedure needs on a cell.

    Args:
        bench: as the cell file describes it.
    """
    declared = procedure.needs
    try:
        bench_for(cell, declared, procedure.name)
    except ConfigError as error:
        return [Need("cell file", "missing", str(error))]
    basis = None if declared.basis is None else bases[declared.basis]
    needs = [_equipment(each, bench) for each in declared.equipment]
    needs += [_earlier(after, runs) for after in declared.after]
    needs += [] if basis is None else [basis.need]
    return [*needs, _plan(procedure, bench if basis is None else basis.bench)]


def cell_basis(basis: Basis, bench: Bench, root: Path, runs: CellRuns) -> CellBasis:
    """Return what a run would be planned from, and what is to be said about it."""
    try:
        found = find_basis(basis, bench, root)
    except (UsageError, StorageError) as error:
        return CellBasis(bench, Need(basis.what, "missing", str(error)), None)
    run = runs.named(found.source)
    if run is None:
        text = f"{basis.without}; run {basis.procedure}"
        return CellBasis(found.bench, Need(basis.what, "advised", text), None)
    if run.void:
        text = f"run {run.id}: {run.void}; run {basis.procedure}"
        return CellBasis(found.bench, Need(basis.what, "advised", text), run)
    return CellBasis(found.bench, Need(basis.what, "met", f"run {run.id}, {age_text(run.age_s)}"), run)


def _equipment(equipment: Equipment, bench: Bench) -> Need:
    found = equipment.found(bench)
    return Need(equipment.what, "met" if found else "advised", found or equipment.without)


def _earlier(after: After, runs: CellRuns) -> Need:
    """Return whether a procedure that should have been run was, and lately enough."""
    run, limit_s = runs.last_counting(after.procedure, after.fresh_for_s), after.fresh_for_s
    if run is not None:
        return Need(after.what, "met", f"run {run.id}, {age_text(run.age_s)}")
    lately = "on this cell" if limit_s is None else f"in {limit_s / 3600:g} h"
    return Need(after.what, "advised", f"none {lately}; run {after.procedure}")


def _plan(procedure: Procedure, bench: Bench) -> Need:
    try:
        procedure.plan(bench, procedure.params_type())
    except ProcedureError as error:
        return Need("plan", "missing", str(error))
    except ValidationError as error:
        lacking = ", ".join(str(fault["loc"][0]) for fault in error.errors())
        return Need("plan", "advised", f"known once these parameters are given: {lacking}")
    return Need("plan", "met", "limits hold with default parameters")
