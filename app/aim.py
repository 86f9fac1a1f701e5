"""The aim that a measurement is planned with: what a search found, or the cell file's rough places."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.errors import UsageError
from app.store.catalog import list_runs, resolve_run
from app.store.reader import RunReader
from procedures.bench import Bench

SEARCH = "reflector-search"


@dataclass(frozen=True)
class Aim:
    """A bench to plan with, and where its aim comes from.

    Attributes:
        bench: the bench, aimed.
        source: name of the search run, or "cell file".
    """

    bench: Bench
    source: str


def find_aim(bench: Bench, root: Path, wanted: str = "auto") -> Aim:
    """Aim a bench.

    Args:
        bench: as the cell file describes it.
        root: folder of all runs.
        wanted: "auto" takes the newest complete search of this cell, "none" the cell file's rough places,
            anything else names a search run.

    Raises:
        UsageError: the named run is no complete search of this cell.
    """
    if wanted == "none":
        return Aim(bench, "cell file")
    if wanted == "auto":
        found = _newest(root, bench.name)
        return Aim(bench, "cell file") if found is None else _aimed(bench, found)
    path = resolve_run(root, wanted)
    if _solution(RunReader(path)) is None:
        raise UsageError(f"{path.name} is no complete reflector search; search first: catseye run {SEARCH}")
    return _aimed(bench, path)


def search_result(path: Path) -> dict[str, Any] | None:
    """Return what a search run found: reflectors with uncertainties and θ40; None when it found nothing."""
    return _solution(RunReader(path))


def _newest(root: Path, cell: str) -> Path | None:
    for run in reversed(list_runs(root)):
        if run.procedure == SEARCH and run.status == "complete":
            reader = RunReader(run.path)
            if reader.meta.get("cell") == cell and _solution(reader) is not None:
                return run.path
    return None


def _aimed(bench: Bench, path: Path) -> Aim:
    solution = _solution(RunReader(path))
    if solution is None:
        raise UsageError(f"{path.name} holds no result of a search")
    places = {place["name"]: (place["x_mm"], place["y_mm"]) for place in solution["reflectors"]}
    return Aim(bench.aimed(places, solution["theta40_deg"]), path.name)


def _solution(reader: RunReader) -> dict[str, Any] | None:
    results = [step.result for step in reader.steps() if step.step_id == "solve"]
    return dict(results[-1]) if results else None
