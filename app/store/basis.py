"""The earlier run that a plan is made from, as a procedure declares it; the cell file alone where there is none."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar, cast

from catseye.app.cell.bench import system_of
from catseye.app.errors import UsageError
from catseye.app.store.catalog import list_runs, resolve_run
from catseye.app.store.reader import Accept, RunReader
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.needs import Basis

CELL_FILE = "cell file"
"""Source of a bench without an earlier run."""

AnyBench = TypeVar("AnyBench", bound=Bench)


@dataclass(frozen=True)
class FoundBasis(Generic[AnyBench]):
    """A bench to plan with, and where what is known of it comes from.

    Attributes:
        bench: with what the earlier run found.
        source: name of that run, or "cell file".
        simulated: whether it was made on emulated devices; None without one.
    """

    bench: AnyBench
    source: str
    simulated: bool | None = None


def find_basis(
    basis: Basis | None,
    bench: AnyBench,
    root: Path,
    wanted: str = "auto",
    opened: Callable[[Path], RunReader] = RunReader,
) -> FoundBasis[AnyBench]:
    """Find the earlier run that a plan is made from.

    Args:
        basis: what is looked for; None for nothing.
        bench: as the cell file describes it.
        wanted: "auto" takes the newest complete run that fits this bench, "none" the cell file, anything else names a
            run.
        opened: opens a run, on the terms of what is to be planned.

    Raises:
        UsageError: the named run found nothing, or belongs to another bench; what the newest run found has been
            changed since.
        StorageError: the run that would be taken is damaged or was changed.
    """
    if basis is None or wanted == "none":
        return FoundBasis(bench, CELL_FILE)
    if wanted == "auto":
        newest = _newest(basis, root, bench)
        if newest is None:
            return FoundBasis(bench, CELL_FILE)
        _require_valid(basis, root, bench, newest)
        return _applied(basis, bench, opened(newest))
    path = resolve_run(root, wanted)
    reader = opened(path)
    if basis.found(reader) is None:
        raise UsageError(f"{path.name} {basis.missing}")
    if not basis.fits(bench, reader):
        raise UsageError(f"{path.name} {basis.misfit}")
    return _applied(basis, bench, reader)


def _newest(basis: Basis, root: Path, bench: Bench) -> Path | None:
    for run in reversed(list_runs(root)):
        if run.procedure == basis.procedure and run.status == "complete":
            reader = RunReader(run.path, Accept.UNCHECKED)
            if (
                reader.meta.get("cell") == bench.name
                and basis.found(reader) is not None
                and basis.fits(bench, reader)
            ):
                return run.path
    return None


def _require_valid(basis: Basis, root: Path, bench: Bench, taken: Path) -> None:
    """Refuse a run after which the bench was changed; a named one is taken at the operator's word."""
    for run in reversed(list_runs(root)):
        if run.name <= taken.name:
            return
        if run.procedure not in basis.overtaken_by or run.status == "damaged":
            continue
        # Measurements are large, and one that was changed since can only refuse: they are not checked for this.
        reader = RunReader(run.path, Accept.UNCHECKED)
        if reader.meta.get("cell") == bench.name and basis.overtakes(reader):
            raise UsageError(f"{run.name} {basis.overtaken.format(run=taken.name)}")


def _applied(basis: Basis, bench: AnyBench, reader: RunReader) -> FoundBasis[AnyBench]:
    found = basis.found(reader)
    if found is None:
        raise UsageError(f"{reader.path.name} holds no result of a {basis.what}")
    # What is found makes a bench of the same system.
    informed = cast("AnyBench", system_of(bench).aimed(found))
    return FoundBasis(informed, reader.path.name, bool(reader.meta.get("simulated")))
