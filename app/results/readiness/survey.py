"""Everything that is known about what a cell is ready for."""

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.bench import scara_bench_of
from catseye.app.protocol.procedures import Runnable, load_procedure, procedure_names
from catseye.app.results.readiness.cell_runs import CellRuns, runs_of_cell
from catseye.app.results.readiness.need import Need
from catseye.app.results.readiness.needs import aim_of, needs_of
from catseye.app.results.readiness.stages import Stage, results_in, stages_of


@dataclass(frozen=True)
class Survey:
    """What a cell is ready for.

    Attributes:
        cell: its name.
        procedures: that are installed.
        needs: of each, by name.
        runs: of this cell.
        stages: on the way to a validated error map.
    """

    cell: str
    procedures: list[Runnable]
    needs: dict[str, list[Need]]
    runs: CellRuns
    stages: list[Stage]

    @property
    def next(self) -> Stage | None:
        """The next sensible stage."""
        return next((stage for stage in self.stages if stage.state == "next"), None)


def survey_cell(path: Path, root: Path, now: datetime) -> Survey:
    """Return what a cell is ready for.

    Results are looked for beside the cell file, beside the folder of runs, and in it.

    Args:
        path: cell file.
        root: folder of all runs.
        now: UTC time.

    Raises:
        ConfigError: the cell file cannot be used.
    """
    cell = load_cell(path).cell
    bench, runs = scara_bench_of(cell), runs_of_cell(root, cell.name, now)
    procedures = [load_procedure(name) for name in procedure_names()]
    aim = aim_of(bench, root, runs)
    needs = {procedure.name: needs_of(procedure, bench, aim, runs) for procedure in procedures}
    results = results_in((path.parent, root.absolute().parent, root))
    after = [earlier for procedure in procedures for earlier in procedure.needs.after]
    stages = stages_of(runs, needs, aim.search, results, path, after)
    return Survey(cell.name, procedures, needs, runs, stages)
