"""The runs of one cell, as far as they decide what comes next."""

from dataclasses import dataclass, replace
from datetime import datetime
from functools import reduce
from pathlib import Path
from typing import Literal

from catseye.app.errors import StorageError
from catseye.app.results.readiness.bench_seen import NOTHING_SEEN, BenchSeen, seen_by_run
from catseye.app.store.catalog import list_runs
from catseye.app.store.reader import Accept, RunReader, Status
from catseye.app.store.resumable import why_not_resumable
from catseye.app.store.run_names import JOB


@dataclass(frozen=True)
class CellRun:
    """A run.

    Attributes:
        name: of the run.
        procedure: what was run.
        status: how it ended; damaged when it cannot be read.
        age_s: time since its last sign of life.
        resumable: it can go on.
        void: why the bench is no longer the one that it was made on, in a few words; empty where nobody knows of
            that.
        job: of a campaign that it belongs to; empty for none.
    """

    name: str
    procedure: str
    status: Status | Literal["damaged"]
    age_s: float
    resumable: bool
    void: str = ""
    job: str = ""

    @property
    def id(self) -> str:
        """Its six hexadecimal digits, which every command takes for its name."""
        return self.name.rpartition("_")[2]

    @property
    def complete(self) -> bool:
        """It came to its end."""
        return self.status == "complete"


class CellRuns:
    """All runs of one cell, oldest first."""

    def __init__(self, runs: list[CellRun]) -> None:
        self._runs = runs

    @property
    def newest(self) -> CellRun | None:
        """The newest run of any procedure."""
        return self._runs[-1] if self._runs else None

    def last(self, procedure: str) -> CellRun | None:
        """Return the newest run of a procedure."""
        return next((run for run in reversed(self._runs) if run.procedure == procedure), None)

    def last_complete(self, procedure: str) -> CellRun | None:
        """Return the newest complete run of a procedure."""
        found = (run for run in reversed(self._runs) if run.procedure == procedure and run.complete)
        return next(found, None)

    def last_counting(
        self, procedure: str, fresh_for_s: float | None, after: CellRun | None = None
    ) -> CellRun | None:
        """Return the newest complete run of a procedure that the bench still stands for, if it is fresh enough.

        Args:
            fresh_for_s: it counts for so long; None for ever.
            after: an older one than this does not count.
        """
        held = (
            run
            for run in reversed(self._runs)
            if run.procedure == procedure and run.complete and not run.void
        )
        run = next(held, None)
        if run is None or (after is not None and run.name < after.name):
            return None
        return None if fresh_for_s is not None and run.age_s > fresh_for_s else run

    def of_job(self, job: str) -> "CellRuns":
        """Return the runs of one job."""
        return CellRuns([run for run in self._runs if run.job == job])

    def named(self, name: str) -> CellRun | None:
        """Return a run by its name."""
        return next((run for run in self._runs if run.name == name), None)


def runs_of_cell(root: Path, cell: str, now: datetime, present: BenchSeen = NOTHING_SEEN) -> CellRuns:
    """Return the runs of a cell.

    Args:
        now: UTC time.
        present: what is seen of the bench now; the newest run that knows tells the rest.
    """
    found: list[tuple[CellRun, BenchSeen]] = []
    for run in list_runs(root):
        try:
            reader = RunReader(run.path, Accept.UNCHECKED)
            meta = reader.meta
            if meta.get("cell") != cell:
                continue
            going = run.status not in {"complete", "running", "damaged"} and not why_not_resumable(reader)
            last = datetime.fromisoformat(reader.events()[-1].time_utc)
            age_s = max(0.0, (now - last).total_seconds())
        except (StorageError, IndexError, TypeError, ValueError):
            # Nobody knows whose a run is that cannot be read; a changed one may have any text for a time.
            continue
        one = CellRun(run.name, run.procedure, run.status, age_s, going, job=str(meta.get(JOB) or ""))
        found.append((one, seen_by_run(meta)))
    known = reduce(BenchSeen.updated, (*(seen for _, seen in found), present), NOTHING_SEEN)
    return CellRuns([replace(run, void=seen.why_no_longer(known)) for run, seen in found])
