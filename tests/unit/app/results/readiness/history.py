"""A cell whose runs were made one an hour, and what the readiness of its stages follows from."""

import os
import time
from collections.abc import Mapping
from datetime import timedelta
from pathlib import Path

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cli.init import init
from catseye.app.protocol.installed import procedure_names
from catseye.app.protocol.procedures import bases, procedures
from catseye.app.results.readiness.bench_seen import NOTHING_SEEN, BenchSeen
from catseye.app.results.readiness.cell_runs import runs_of_cell
from catseye.app.results.readiness.headline import Headline, Headlines
from catseye.app.results.readiness.need import Need
from catseye.app.results.readiness.needs import cell_basis
from catseye.app.results.readiness.stages import CellStage, Place, stages_of
from catseye.app.results.readiness.survey import Survey, survey_cell
from catseye.app.results.stored_results import by_run, results_in, stored_results
from catseye.app.store.run_store import RunStore
from catseye.procedures.kit.records import Json
from tests.unit.app.engine.fakes import ManualClock


def of_names(found: Mapping[str, Headline]) -> Headlines:
    """Return the figures of runs and of written files by their names."""
    return Headlines(
        of_run=lambda run: found.get(run.name), of_written=lambda written: found.get(written.file.name)
    )


class History:
    """A cell's runs, made one an hour."""

    def __init__(self, folder: Path) -> None:
        self.cell, self.root = folder / "cell.toml", folder / "runs"
        init(self.cell)
        self.clock = ManualClock()
        self.written_s = time.time()
        self.bench = scara_bench_of(load_cell(self.cell).cell)
        self.taken: frozenset[str] = frozenset()

    async def put(
        self, procedure: str, status: str = "complete", cell: str = "lab-1", started: str = ""
    ) -> str:
        places: list[Json] = [{"name": r.name, "x_mm": r.x_mm, "y_mm": r.y_mm} for r in self.bench.reflectors]
        meta: dict[str, Json] = {
            "cell": cell,
            "configuration": {"reflector": places},
            "bench_started": started,
        }
        store = await RunStore.create(self.root, procedure, meta, self.clock, reserve_bytes=0)
        if procedure == "reflector-search" and status == "complete":
            found: dict[str, Json] = {"reflectors": places, "theta40_deg": 0.0}
            await store.append_step("solve", 1, "solve", found, [])
        await store.finish(status, 0)
        self.clock.advance(3600.0)
        return store.path.name

    def survey(self) -> Survey:
        """Return everything."""
        return survey_cell(self.cell, self.root, self.clock.now_utc())

    def write(self, name: str, text: str = "") -> None:
        """Write a file beside the cell, a second after what was written before."""
        self.written_s += 1.0
        path = self.cell.parent / name
        path.write_text(text)
        os.utime(path, (self.written_s, self.written_s))

    def stages(
        self,
        later_s: float = 0.0,
        headlines: Mapping[str, Headline] | None = None,
        present: BenchSeen = NOTHING_SEEN,
    ) -> dict[str, CellStage]:
        """Return the stages by name, without the plans of all procedures: those take their time."""
        runs = runs_of_cell(self.root, "lab-1", self.clock.now_utc() + timedelta(seconds=later_s), present)
        needs: dict[str, list[Need]] = {name: [] for name in procedure_names()}
        made = {
            each.procedure: cell_basis(each, self.bench, self.root, runs).run for each in bases(self.bench)
        }
        found = stages_of(
            procedures(),
            runs,
            needs,
            made,
            results_in([self.cell.parent]),
            Place(
                self.cell,
                folders=[self.cell.parent],
                runs_in=self.root,
                headlines=of_names(headlines or {}),
                beside=by_run(one for one in stored_results([self.cell.parent]) if not one.counts),
                taken=self.taken,
            ),
        )
        # Two ways end with the same command: that of this arm comes first.
        return {stage.name: stage for stage in reversed(found)}

    def data_stage(self, name: str) -> CellStage:
        """Return the only stage of that name on the way of steps that is work on stored data."""
        runs = runs_of_cell(self.root, "lab-1", self.clock.now_utc())
        folder = self.cell.parent
        needs: dict[str, list[Need]] = {each: [] for each in procedure_names()}
        of_steps = [
            each for each in procedures() if each.stage is not None and each.stage.way == "resolution"
        ]
        place = Place(self.cell, folders=[folder])
        found = stages_of(of_steps, runs, needs, {}, results_in([folder]), place)
        (stage,) = [each for each in found if each.name == name and not each.procedure]
        return stage

    def next(self, later_s: float = 0.0) -> str:
        """Return the name of the only stage that is the next."""
        (name,) = [name for name, stage in self.stages(later_s).items() if stage.state == "next"]
        return name
