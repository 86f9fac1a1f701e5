"""The search that a measurement is aimed with: where the reflectors stand, and the beam's zero direction."""

from typing import Any, Final

from catseye.procedures.kit.needs import Basis, EarlierRun
from catseye.procedures.kit.records import Row
from catseye.procedures.scara.bench import ScaraBench

_SOLUTION: Final = "solve"


def search_result(run: EarlierRun) -> dict[str, Any] | None:
    """Return what a search found: reflectors with uncertainties and θ40; None when it found nothing."""
    found = run.result(_SOLUTION)
    return None if found is None else dict(found)


def _found(run: EarlierRun) -> Row | None:
    solution = search_result(run)
    if solution is None:
        return None
    places = {place["name"]: [place["x_mm"], place["y_mm"]] for place in solution["reflectors"]}
    return {"reflectors": places, "theta40_deg": solution["theta40_deg"]}


def _fits(bench: ScaraBench, run: EarlierRun) -> bool:
    """Return whether a search looked for the reflectors of this bench where this bench's cell file has them."""
    configuration: Any = run.meta.get("configuration") or {}
    searched = {row["name"]: (row["x_mm"], row["y_mm"]) for row in configuration.get("reflector", ())}
    return searched == {reflector.name: (reflector.x_mm, reflector.y_mm) for reflector in bench.reflectors}


def _moved_beam(run: EarlierRun) -> bool:
    """Return whether hands were sent to the stage, or to turn the interferometer.

    A question that a process died over may have been acted on.
    """
    asked = {str(data["id"]) for data in run.data_of("asked")}
    refused = {name for name, answer in run.answers().items() if answer == "no"}
    return any(name.startswith(("stage/", "mount/")) for name in asked - refused)


SEARCHED: Final = Basis(
    procedure="reflector-search",
    what="search",
    without="rough places only",
    found=_found,
    missing="is not a complete reflector search; search first: catseye run reflector-search",
    fits=_fits,
    misfit="searched reflectors at other rough places than the cell file's: search again, or plan with "
    "--search none",
    overtaken_by=("beam-to-j4", "open-loop"),
    overtakes=_moved_beam,
    overtaken="moved the beam after {run} had searched with it: its places and θ40 are no longer valid. "
    "Search again (catseye run reflector-search), or take the old aim all the same with --search {run}",
)
