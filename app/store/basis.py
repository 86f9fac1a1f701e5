"""The aim that a measurement is planned with: what a search found, or the cell file's rough places."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar, cast

from catseye.app.errors import UsageError
from catseye.app.store.catalog import list_runs, resolve_run
from catseye.app.store.reader import Accept, RunReader
from catseye.procedures.kit.bench import Bench
from catseye.procedures.scara.bench import ScaraBench

SEARCH = "reflector-search"
_ALIGNMENT = "beam-to-j4"

AnyBench = TypeVar("AnyBench", bound=Bench)


@dataclass(frozen=True)
class Aim(Generic[AnyBench]):
    """A bench to plan with, and where its aim comes from.

    Attributes:
        bench: the bench, aimed.
        source: name of the search run, or "cell file".
        simulated: whether that search was made on emulated devices; None without a search.
    """

    bench: AnyBench
    source: str
    simulated: bool | None = None


def find_aim(
    bench: AnyBench, root: Path, wanted: str = "auto", opened: Callable[[Path], RunReader] = RunReader
) -> Aim[AnyBench]:
    """Aim a bench; one that no search knows is as the cell file describes it.

    Args:
        bench: as the cell file describes it.
        root: folder of all runs.
        wanted: "auto" takes the newest complete search of this cell with these rough places, "none" the cell
            file's rough places, anything else names a search run.
        opened: opens a run, on the terms of what is to be aimed.

    Raises:
        UsageError: the named run is no complete search, or one of other reflectors; the newest search is older than
            an alignment that moved the beam.
        StorageError: the run that would be taken is damaged or was changed.
    """
    if wanted == "none" or not isinstance(bench, ScaraBench):
        return Aim(bench, "cell file")
    return cast("Aim[AnyBench]", _find_aim(bench, root, wanted, opened))


def _find_aim(
    bench: ScaraBench, root: Path, wanted: str, opened: Callable[[Path], RunReader]
) -> Aim[ScaraBench]:
    if wanted == "auto":
        found = _newest(root, bench)
        if found is None:
            return Aim(bench, "cell file")
        _require_beam_unmoved(root, bench, found)
        return _aimed(bench, opened(found))
    path = resolve_run(root, wanted)
    reader = opened(path)
    if search_result(reader) is None:
        raise UsageError(f"{path.name} is no complete reflector search; search first: catseye run {SEARCH}")
    if not _same_places(bench, reader):
        raise UsageError(
            f"{path.name} searched reflectors at other rough places than the cell file's: search again, or plan with "
            "--search none"
        )
    return _aimed(bench, reader)


def _newest(root: Path, bench: ScaraBench) -> Path | None:
    for run in reversed(list_runs(root)):
        if run.procedure == SEARCH and run.status == "complete":
            reader = RunReader(run.path, Accept.UNCHECKED)
            if (
                reader.meta.get("cell") == bench.name
                and search_result(reader)
                and _same_places(bench, reader)
            ):
                return run.path
    return None


def _require_beam_unmoved(root: Path, bench: ScaraBench, search: Path) -> None:
    """Refuse a search whose beam passed the J4 axis elsewhere; a named one is taken at the operator's word."""
    for run in reversed(list_runs(root)):
        if run.name <= search.name:
            return
        if (
            run.procedure == _ALIGNMENT
            and run.status != "damaged"
            and _moved_beam(RunReader(run.path), bench)
        ):
            raise UsageError(
                f"{run.name} moved the beam after {search.name} had searched with it: its places and θ40 do not hold "
                f"any more. Search again (catseye run {SEARCH}), or take the old aim all the same with --search "
                f"{search.name}"
            )


def _moved_beam(reader: RunReader, bench: ScaraBench) -> bool:
    """Return whether hands were sent to the stage; a question that a process died over may have been acted on."""
    asked = [event for event in reader.events() if event.kind == "asked"]
    stage = {str(event.data["id"]) for event in asked if str(event.data["id"]).startswith("stage/")}
    refused = {str(prompt["id"]) for prompt in reader.prompts() if prompt["answer"] == "no"}
    return reader.meta.get("cell") == bench.name and bool(stage - refused)


def _same_places(bench: ScaraBench, reader: RunReader) -> bool:
    """Return whether a search looked for the reflectors of this bench where this bench's cell file has them."""
    configuration: Any = reader.meta.get("configuration") or {}
    searched = {row["name"]: (row["x_mm"], row["y_mm"]) for row in configuration.get("reflector", ())}
    return searched == {reflector.name: (reflector.x_mm, reflector.y_mm) for reflector in bench.reflectors}


def _aimed(bench: ScaraBench, reader: RunReader) -> Aim[ScaraBench]:
    solution = search_result(reader)
    if solution is None:
        raise UsageError(f"{reader.path.name} holds no result of a search")
    places = {place["name"]: (place["x_mm"], place["y_mm"]) for place in solution["reflectors"]}
    simulated = bool(reader.meta.get("simulated"))
    return Aim(bench.aimed(places, solution["theta40_deg"]), reader.path.name, simulated)


def search_result(reader: RunReader) -> dict[str, Any] | None:
    """Return what a search run found: reflectors with uncertainties and θ40; None when it found nothing."""
    results = [step.result for step in reader.steps() if step.step_id == "solve"]
    return dict(results[-1]) if results else None
