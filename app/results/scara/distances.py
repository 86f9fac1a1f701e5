"""Where distances come from: runs, or a points file with its cell file."""

from dataclasses import dataclass
from pathlib import Path

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.load import load_cell
from catseye.app.errors import UsageError
from catseye.app.protocol.banners import unverified_text
from catseye.app.results.scara.identify import bench_of_runs, run_points
from catseye.app.results.scara.points import read_points
from catseye.app.results.scara.stated_budget import (
    BudgetChoice,
    StatedBudget,
    budget_of_runs,
    budget_of_table,
    other_budgets,
)
from catseye.app.results.scara.table_budget import SeenTable
from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import RunReader, accept
from catseye.app.store.runs_folder import runs_folder
from catseye.app.store.unverified import taken_as_it_is
from catseye.procedures.kit.columns import Columns
from catseye.procedures.scara.bench import ScaraBench


@dataclass(frozen=True)
class DistanceSource:
    """Distances with what is needed to identify an arm from them.

    Attributes:
        points: distances in measuring order.
        bench: nodes, nominal links and rough reflectors.
        stated: the error budget that counts.
        names: of the runs or of the points file.
        readers: the runs; none for a points file.
        warnings: sentences about runs that did not end.
    """

    points: Columns
    bench: ScaraBench
    stated: StatedBudget
    names: list[str]
    readers: list[RunReader]
    warnings: list[str]


def load_distances(
    run: list[str],
    points: Path | None,
    cell: Path | None,
    runs: Path | None,
    unverified: bool = False,
    budget: BudgetChoice | None = None,
) -> DistanceSource:
    """Read distances.

    Args:
        run: runs by path, name, beginning of a name, or id.
        runs: folder of the runs; None for the usual one.
        unverified: take sealed runs and tables too that were changed.
        budget: which error budget counts; None for the table's own, else the cell's.

    Raises:
        UsageError: neither or both are given, or a file is wrong; names it.
        StorageError: a run is damaged or was changed.
    """
    if bool(run) == (points is not None):
        raise UsageError("give either runs, or --points FILE with --cell FILE")
    if points is not None:
        return _of_file(points, cell, budget, unverified=unverified)
    root = runs_folder(runs)
    readers = [RunReader(resolve_run(root, text), accept(unverified=unverified)) for text in run]
    warnings = [
        f"{reader.path.name} is {reader.status}; identifying from what it holds"
        for reader in readers
        if reader.status != "complete"
    ]
    names = [reader.path.name for reader in readers]
    with taken_as_it_is(*readers):
        distances, bench = run_points(readers), bench_of_runs(readers, root)
        # Behind the reading, which finds what speaks against the runs.
        stated = budget_of_runs(readers, budget)
        warnings += other_budgets(readers)
    warnings += dict.fromkeys(map(unverified_text, stated.unverified))
    return DistanceSource(distances, bench, stated, names, readers, warnings)


def _of_file(
    points: Path, cell: Path | None, budget: BudgetChoice | None, *, unverified: bool
) -> DistanceSource:
    if cell is None:
        raise UsageError("--points needs --cell FILE: nodes, nominal links and rough reflectors stand there")
    loaded = load_cell(cell)
    names = [reflector.name for reflector in loaded.cell.reflector]
    distances, bench = read_points(points, names), scara_bench_of(loaded.cell)
    seen = SeenTable(points)
    seen.see(distances)
    stated = budget_of_table(seen, loaded.cell.uncertainty, cell.name, budget, unverified=unverified)
    warnings = list(map(unverified_text, stated.unverified))
    return DistanceSource(stated.counted_columns(distances), bench, stated, [points.name], [], warnings)
