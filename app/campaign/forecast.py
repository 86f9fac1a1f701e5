"""What a job has still to do, and how long that took the last time; nothing is done."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Final

from catseye.app.campaign.model import StageEntry
from catseye.app.errors import StorageError
from catseye.app.results.readiness.cell_runs import CellRuns
from catseye.app.results.readiness.stages import CellStage
from catseye.app.store.reader import Accept, RunReader

_BEGINS: Final = frozenset({"run-opened", "run-reopened"})
_ENDS: Final = "run-ended"

Took = Callable[[str], float | None]
"""Returns how long a run of this name took, bench s; None where nobody knows; blocks."""


@dataclass(frozen=True)
class Expected:
    """One stage of a job that has not begun, or goes on.

    Attributes:
        stage: its name.
        holds: it is done and holds, and is not done again.
        bench_s: time that its procedure took the last time, bench s; None where it never ran, and for work on stored
            data, which takes seconds to minutes.
        run: by which that is known; empty for none.
    """

    stage: str
    holds: bool
    bench_s: float | None = None
    run: str = ""


def forecast(
    entries: Sequence[StageEntry], stages: Sequence[CellStage], runs: CellRuns, took: Took
) -> list[Expected]:
    """Return what is to be expected of each stage.

    Args:
        entries: of the campaign.
        stages: of the cell, as far as the job counts.
        runs: of the cell, of every job.
        took: how long one of them took.
    """
    known = {stage.name: stage for stage in stages}
    found = []
    for entry in entries:
        stage = known.get(entry.name)
        last = None if stage is None or not stage.procedure else runs.last_complete(entry.name)
        found.append(
            Expected(
                entry.name,
                stage is not None and stage.state == "done",
                None if last is None else took(last.name),
                "" if last is None else last.name,
            )
        )
    return found


def left_bench_s(expected: Sequence[Expected]) -> float:
    """Return how long what is known of the rest takes, bench s."""
    return sum(one.bench_s or 0.0 for one in expected if not one.holds)


def took_bench_s(root: Path, run: str) -> float | None:
    """Return how long a run took without its interruptions, bench s; None for one that cannot be read."""
    try:
        reader = RunReader(root / run, Accept.UNCHECKED)
        speed, events = reader.clock_speed, reader.events()
    except StorageError:
        return None
    if speed is None:
        return None
    seconds, begun = 0.0, None
    for event in events:
        if event.kind in _BEGINS:
            begun = datetime.fromisoformat(event.time_utc)
        elif event.kind == _ENDS and begun is not None:
            seconds += (datetime.fromisoformat(event.time_utc) - begun).total_seconds()
            begun = None
    return seconds * speed
