"""Everything that is known about what a cell is ready for."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Final

from catseye.app.cell.bench import bench_of
from catseye.app.cell.load import load_cell
from catseye.app.protocol.procedures import bases, procedures
from catseye.app.results.readiness.bench_seen import NOTHING_SEEN, BenchSeen, arm_stated
from catseye.app.results.readiness.cell_runs import CellRuns, runs_of_cell
from catseye.app.results.readiness.headline import NO_HEADLINES, Headlines
from catseye.app.results.readiness.need import Need
from catseye.app.results.readiness.needs import cell_basis, needs_of
from catseye.app.results.readiness.stages import CellStage, Place, stages_of
from catseye.app.results.stored_results import by_run, stored_results
from catseye.app.store.runs_folder import runs_folder
from catseye.procedures.kit.procedure import Procedure


@dataclass(frozen=True)
class Survey:
    """What a cell is ready for.

    Attributes:
        cell: its name.
        procedures: that are installed.
        needs: of each, by name.
        runs: of this cell.
        stages: on the way to a validated result.
    """

    cell: str
    procedures: list[Procedure]
    needs: dict[str, list[Need]]
    runs: CellRuns
    stages: list[CellStage]

    @property
    def next(self) -> CellStage | None:
        """The next sensible stage."""
        return next((stage for stage in self.stages if stage.state == "next"), None)


@dataclass(frozen=True)
class Scope:
    """What of a cell counts.

    Attributes:
        job: only runs of this job of a campaign; empty for any run.
        folder: what is written without the id of a run in its name goes there; None for where everything goes.
        procedures: whose plans are tried; None for all.
    """

    job: str = ""
    folder: Path | None = None
    procedures: frozenset[str] | None = None


EVERYTHING: Final = Scope()

Tried = Callable[[int, int, str], None]
"""Called with how many plans were tried, of how many, and the procedure whose plan is next."""


def survey_cell(
    path: Path,
    root: Path,
    now: datetime,
    headlines: Headlines = NO_HEADLINES,
    present: BenchSeen = NOTHING_SEEN,
    tried: Tried = lambda _done, _of, _name: None,
    scope: Scope = EVERYTHING,
) -> Survey:
    """Return what a cell is ready for.

    Results are looked for beside the cell file, beside the folder of runs, and in it.

    Args:
        now: UTC time.
        headlines: what stands for finished stages.
        present: what is seen of the bench now.
        tried: hears how far it is: the plan of every procedure is tried, which takes seconds of some.
        scope: what counts.

    Raises:
        ConfigError: the cell file cannot be used.
    """
    cell = load_cell(path).cell
    seen = replace(present, arm=arm_stated(cell.model_dump(mode="json")))
    bench, runs = bench_of(cell), runs_of_cell(root, cell.name, now, seen)
    if scope.job:
        runs = runs.of_job(scope.job)
    installed = procedures()
    if scope.procedures is not None:
        installed = [each for each in installed if each.name in scope.procedures]
    found = {basis: cell_basis(basis, bench, root, runs) for basis in bases(bench)}
    needs = {}
    for number, each in enumerate(installed):
        tried(number, len(installed), each.name)
        needs[each.name] = needs_of(each, cell, bench, found, runs)
    usual = (path.parent, root.absolute().parent, root)
    folders = usual if scope.folder is None else (scope.folder, *usual)
    stored = stored_results(folders)
    results = by_run(one for one in stored if one.counts)
    made = {basis.procedure: each.run for basis, each in found.items()}
    place = Place(
        path,
        cell.robot.arm if isinstance(cell.robot.arm, str) else "",
        () if root == runs_folder(None) else ("--runs", str(root)),
        _beside(root),
        folders,
        root,
        headlines,
        by_run(one for one in stored if not one.counts),
        frozenset(entry.measured_by for entry in cell.uncertainty.contributor if entry.measured_by),
    )
    stages = stages_of(installed, runs, needs, made, results, place)
    return Survey(cell.name, installed, needs, runs, stages)


def _beside(root: Path) -> Path:
    """Return the folder beside the runs: a run's own folder is sealed."""
    folder = root.absolute().parent
    return Path() if folder == Path.cwd() else folder
