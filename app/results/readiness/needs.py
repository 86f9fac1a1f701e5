"""What a procedure needs on a cell, whether that is met, and what to do when it is not."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from pydantic import ValidationError

from catseye.app.errors import StorageError, UsageError
from catseye.app.protocol.procedures import Runnable
from catseye.app.results.readiness.cell_runs import CellRun, CellRuns
from catseye.app.results.readiness.need import Need
from catseye.app.results.readiness.words import age_text
from catseye.app.store.aim import find_aim
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.errors import ProcedureError

LEVEL: Final = "beam-level"
ALIGNMENT: Final = "beam-to-j4"
SEARCH: Final = "reflector-search"
WARM_UP: Final = "warmup"
MEASUREMENT: Final = "open-loop"

WARM_S: Final = 4 * 3600.0
"""A warm-up counts for so long: links and drives cool down within hours."""

_WARM_FIRST: Final = frozenset({MEASUREMENT, "repeatability"})
_BEFORE_ALIGNMENT: Final = frozenset({LEVEL, ALIGNMENT})


@dataclass(frozen=True)
class FoundAim:
    """What a run would be aimed with.

    Attributes:
        bench: aimed; as the cell file has it where there is nothing better.
        need: what is to be said about it.
        search: the run that found it; None without one.
    """

    bench: Bench
    need: Need
    search: CellRun | None


def needs_of(procedure: Runnable, bench: Bench, aim: FoundAim, runs: CellRuns) -> list[Need]:
    """Return what a procedure needs on a cell.

    Args:
        procedure: which.
        bench: as the cell file describes it.
        aim: what it would be aimed with.
        runs: of this cell.
    """
    needs = [_reflectors(bench), *_beam(procedure.name, runs)]
    if procedure.needs_aim:
        needs.append(aim.need)
    needs += _warmth(procedure.name, runs)
    needs += _tracker(procedure, bench)
    needs.append(_plan(procedure, aim.bench if procedure.needs_aim else bench))
    return needs


def aim_of(bench: Bench, root: Path, runs: CellRuns) -> FoundAim:
    """Return the aim that a run would be planned with, and what is to be said about it."""
    try:
        aim = find_aim(bench, root)
    except (UsageError, StorageError) as error:
        return FoundAim(bench, Need("search", "missing", str(error)), None)
    run = runs.named(aim.source)
    if run is None:
        return FoundAim(aim.bench, Need("search", "advised", f"rough places only; run {SEARCH}"), None)
    return FoundAim(aim.bench, Need("search", "met", f"run {run.id}, {age_text(run.age_s)}"), run)


def is_warm(runs: CellRuns) -> bool:
    """Return whether the arm has been warmed up lately."""
    run = runs.last_complete(WARM_UP)
    return run is not None and run.age_s <= WARM_S


def _reflectors(bench: Bench) -> Need:
    names = [reflector.name for reflector in bench.reflectors]
    one = ", one cat's eye that is carried from nest to nest" if bench.optics.one_reflector else ""
    return Need("reflectors", "met", f"{', '.join(names)}{one}")


def _beam(name: str, runs: CellRuns) -> list[Need]:
    if name == LEVEL:
        return []
    before = LEVEL if name in _BEFORE_ALIGNMENT else ALIGNMENT
    what = "levelling" if before == LEVEL else "alignment"
    run = runs.last_complete(before)
    if run is None:
        return [Need(what, "advised", f"none on this cell; run {before}")]
    return [Need(what, "met", f"run {run.id}, {age_text(run.age_s)}")]


def _warmth(name: str, runs: CellRuns) -> list[Need]:
    if name not in _WARM_FIRST:
        return []
    if is_warm(runs):
        run = runs.last_complete(WARM_UP)
        return [Need("warm arm", "met", f"warmed up {age_text(run.age_s)}" if run else "")]
    return [Need("warm arm", "advised", f"none in {WARM_S / 3600:g} h; run {WARM_UP}")]


def _tracker(procedure: Runnable, bench: Bench) -> list[Need]:
    if procedure.needs_tracker and not bench.tracker:
        return [Need("tracker", "missing", "the cell file has none; add a [tracker]")]
    if "instrument" not in procedure.params_type.model_fields and not procedure.needs_tracker:
        return []
    if bench.tracker:
        return [Need("tracker", "met", "in the cell file")]
    text = "none: the interferometer measures, or instrument = file"
    return [Need("tracker", "advised", text)]


def _plan(procedure: Runnable, bench: Bench) -> Need:
    try:
        procedure.plan(bench, procedure.params_type())
    except ProcedureError as error:
        return Need("plan", "missing", str(error))
    except ValidationError:
        return Need("plan", "advised", "it has parameters that have to be given")
    return Need("plan", "met", "limits hold with default parameters")
