"""The way from an unknown bench to a validated error map, and how far a cell has come on it."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from catseye.app.errors import ConfigError
from catseye.app.files.documents import LARGEST_RESULT_BYTES, parse_json, read_document
from catseye.app.results.numbers import age_text
from catseye.app.results.readiness.cell_runs import CellRun, CellRuns
from catseye.app.results.readiness.need import Need
from catseye.app.results.readiness.needs import SEARCH
from catseye.procedures.kit.needs import After

LEVEL = "beam-level"
ALIGNMENT = "beam-to-j4"
WARM_UP = "warmup"
MEASUREMENT = "open-loop"
_PATH = "validation-path"

State = Literal["done", "next", "later", "left out"]


@dataclass(frozen=True)
class Stage:
    """One stage of the way.

    Attributes:
        name: of the procedure or command.
        procedure: it is a procedure on the bench; False is work on stored data.
        state: done, the next one, one for later, or left out since this cell cannot do it.
        text: by what it is done, or what it is for.
        command: what does it; `resume` where an interrupted run of it can go on.
    """

    name: str
    procedure: bool
    state: State
    text: str
    command: str


def stages_of(
    runs: CellRuns,
    needs: dict[str, list[Need]],
    search: CellRun | None,
    results: dict[str, Path],
    cell: Path,
    after: Iterable[After],
) -> list[Stage]:
    """Return the stages, at most one of them the next.

    Args:
        runs: of the cell.
        needs: of each procedure by name.
        search: the run that aims a measurement now.
        results: identified error maps by the name of the run that they hold.
        cell: cell file.
        after: what procedures declare that should have been run before them.
    """
    level = runs.last_complete(LEVEL)
    aligned = runs.last_complete(ALIGNMENT, after=level)
    measured = None if search is None else runs.last_complete(MEASUREMENT, after=search)
    result = None if measured is None else results.get(measured.name)
    path = None if measured is None else runs.last_complete(_PATH, after=measured)
    warm = next((runs.last_counting(earlier) for earlier in after if earlier.procedure == WARM_UP), None)
    done: list[tuple[str, str, bool, str]] = [
        (LEVEL, "the beam in the plane of the arm", level is not None, _by(level)),
        (ALIGNMENT, "the beam through the J4 axis", aligned is not None, _by(aligned)),
        (SEARCH, "where the reflectors stand", search is not None, _by(search)),
        (WARM_UP, "the arm at its working temperature", bool(warm or measured), _warmed(warm, measured)),
        (MEASUREMENT, "the distances", measured is not None, _by(measured)),
        ("identify", "error maps from the distances", result is not None, str(result or "")),
        (_PATH, "a path that shows what the map is worth", path is not None, _by(path)),
        ("validate", "the error map against the path", False, ""),
    ]
    return list(_with_states(done, runs, needs, _Commands(cell, measured, result, path)))


def results_in(folders: Iterable[Path]) -> dict[str, Path]:
    """Return the results of error maps by the names of the runs that they were identified from.

    Args:
        folders: that are looked through, not the ones below them; the first that has one counts.
    """
    found: dict[str, Path] = {}
    for folder in folders:
        for path in sorted(folder.glob("*.json")) if folder.is_dir() else ():
            for run in _runs_of(path):
                found.setdefault(run, path)
    return found


def _with_states(
    done: list[tuple[str, str, bool, str]],
    runs: CellRuns,
    needs: dict[str, list[Need]],
    commands: "_Commands",
) -> Iterable[Stage]:
    open_yet = True
    for name, purpose, is_done, by in done:
        state: State = "done"
        text = by if is_done else purpose
        if not is_done and name in needs and _cannot(needs[name]):
            state, text = "left out", _cannot(needs[name])
        elif (
            not is_done and name in needs and runs.last_complete(name) is None and _any_done_after(name, done)
        ):
            # Whoever went on without it has decided so.
            state, text = "left out", f"gone on without it; {purpose}"
        elif not is_done:
            state, open_yet = ("next" if open_yet else "later"), False
        yield Stage(name, name in needs, state, text, commands.of(name, runs))


def _any_done_after(name: str, done: list[tuple[str, str, bool, str]]) -> bool:
    names = [each[0] for each in done]
    return any(is_done for _, _, is_done, _ in done[names.index(name) + 1 :])


@dataclass(frozen=True)
class _Commands:
    cell: Path
    measured: CellRun | None
    result: Path | None
    path: CellRun | None

    def of(self, name: str, runs: CellRuns) -> str:
        match name:
            case "identify":
                run = self.measured.id if self.measured else "RUN"
                return f"catseye identify {run} -o result-{run}.json"
            case "validate":
                run = self.path.name if self.path else "RUN"
                result = self.result or "RESULT"
                return (
                    f"catseye validate {result} --measured path.csv, from: catseye export {run} -o path.csv"
                )
        last = runs.last(name)
        if last is not None and last.resumable:
            return f"catseye resume {last.name}"
        return f"catseye run {name} --cell {self.cell}"


def _cannot(needs: list[Need]) -> str:
    """Return why a procedure cannot be planned on this cell at all; empty when it can."""
    return next((need.text for need in needs if need.what == "plan" and need.met == "missing"), "")


def _warmed(warm: CellRun | None, measured: CellRun | None) -> str:
    return "the measurement is made" if warm is None and measured is not None else _by(warm)


def _by(run: CellRun | None) -> str:
    return "" if run is None else f"run {run.id}, {age_text(run.age_s)}"


def _runs_of(path: Path) -> list[str]:
    try:
        data = parse_json(read_document(path, largest_bytes=LARGEST_RESULT_BYTES), path)
    except ConfigError:
        return []
    if not isinstance(data, dict) or not str(data.get("format", "")).startswith("catseye-result/"):
        return []
    if data.get("model") != "error-map":
        return []
    provenance = data.get("provenance")
    runs = provenance.get("runs") if isinstance(provenance, dict) else None
    return [str(run) for run in runs] if isinstance(runs, list) else []
