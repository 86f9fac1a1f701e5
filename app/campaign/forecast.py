"""What a job has still to do, and how long that took the last time; nothing is done."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Final

from catseye.app.campaign.model import StageEntry
from catseye.app.errors import StorageError
from catseye.app.results.readiness.cell_runs import CellRuns
from catseye.app.results.readiness.stages import CellStage
from catseye.app.results.readiness.survey import Survey
from catseye.app.store.reader import Accept, RunReader
from catseye.procedures.kit.procedure import Stage

_BEGINS: Final = frozenset({"run-opened", "run-reopened"})
_ENDS: Final = "run-ended"

Took = Callable[[str], float | None]
"""Returns how long a run of this name took, bench s; None where nobody knows; blocks."""

Holds = Callable[[StageEntry, CellStage | None], bool]
"""Returns whether a stage is done, and holds; see `catseye.app.campaign.holding.Holding.holds`."""


@dataclass(frozen=True)
class LastTime:
    """The newest complete run of a procedure.

    Attributes:
        run: its name.
        took_s: how long it would take at the speed of now, real s; None where nobody knows.
    """

    run: str
    took_s: float | None


@dataclass(frozen=True)
class Expected:
    """One stage of a job that has not begun, or goes on.

    Attributes:
        stage: its name.
        holds: it is done and holds, and is not done again.
        expected_s: time that its procedure took the last time, real s; None where it never ran, and for work on
            stored data, which takes seconds to minutes.
        run: by which that is known; empty for none.
    """

    stage: str
    holds: bool
    expected_s: float | None = None
    run: str = ""


@dataclass(frozen=True)
class Rest:
    """What is expected of a stage, and of what is to be done after it.

    Attributes:
        expected_s: how long the stage took the last time, real s; None where nobody knows.
        left_s: the same for all of them, as far as somebody knows; None where nobody does.
        unknown: those that are not counted.
    """

    expected_s: float | None
    left_s: float | None
    unknown: tuple[str, ...]


def last_times(names: Iterable[str], runs: CellRuns, took: Took, speed: float = 1.0) -> dict[str, LastTime]:
    """Return how long procedures took the last time, of those that have a complete run.

    Args:
        runs: of the cell, of every job.
        took: how long one of them took.
        speed: bench seconds in one real second.
    """
    newest = {name: run for name in names if (run := runs.last_complete(name)) is not None}
    times = {name: took(run.name) for name, run in newest.items()}
    return {
        name: LastTime(run.name, None if (bench_s := times[name]) is None else bench_s / speed)
        for name, run in newest.items()
    }


def forecast(
    entries: Sequence[StageEntry], survey: Survey, holds: Holds, times: Mapping[str, LastTime]
) -> list[Expected]:
    """Return what is to be expected of each stage.

    Args:
        entries: of the campaign.
        survey: of the cell, as far as the job counts.
        times: by the name of the procedure.
    """
    stages = {stage.name: stage for stage in survey.stages}
    order = {each.name: each.stage for each in survey.procedures}
    anew: set[str] = set()
    found = []
    for entry in entries:
        stage = None if entry.command else stages.get(entry.name)
        drives = stage is not None and stage.procedure
        # A run counts while what it counts after does; all other work was made with what is done anew.
        lost = not anew.isdisjoint(_counts_after(order.get(entry.name))) if drives else bool(anew)
        kept = holds(entry, stage) and not lost
        if not kept:
            anew.add(entry.name)
        last = times.get(entry.name) if drives else None
        took = ("", None) if last is None else (last.run, last.took_s)
        found.append(Expected(entry.name, kept, took[1], took[0]))
    return found


def rest_of(expected: Sequence[Expected]) -> Rest:
    """Return what is expected of the first of some stages, which is to be done, and of the others."""
    todo = [*expected[:1], *(one for one in expected[1:] if not one.holds)]
    known_s = [one.expected_s for one in todo if one.expected_s is not None]
    unknown = tuple(one.stage for one in todo if one.expected_s is None)
    return Rest(todo[0].expected_s if todo else None, sum(known_s) if known_s else None, unknown)


def _counts_after(stage: Stage | None) -> tuple[str, ...]:
    return () if stage is None else (stage.since, stage.renewed_by)


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
