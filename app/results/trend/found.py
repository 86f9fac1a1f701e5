"""The results of one arm, found by the cell that they were measured on, as a trend."""

from collections.abc import Iterable, Sequence
from functools import reduce
from pathlib import Path

from catseye.app.errors import StorageError, UsageError
from catseye.app.results.numbers import counted
from catseye.app.results.origin import joined
from catseye.app.results.readiness.bench_seen import NOTHING_SEEN, BenchSeen, seen_by_run
from catseye.app.results.resolution.result import read_resolution
from catseye.app.results.scara.result import read_result
from catseye.app.results.serial_arm.result import read_serial_arm
from catseye.app.results.stored_results import StoredResult, stored_result, stored_results
from catseye.app.results.trend.course import Trend
from catseye.app.results.trend.resolution import courses_of_resolution
from catseye.app.results.trend.scara import courses_of_scara
from catseye.app.results.trend.serial_arm import courses_of_serial_arm
from catseye.app.store.reader import Accept, RunReader


def results_of_cell(cell: str, root: Path, folders: Iterable[Path]) -> tuple[list[StoredResult], list[str]]:
    """Return the results of the runs of a cell's arm, and what a reader has to know of the choice.

    Args:
        cell: its name.
        root: folder of the runs.
        folders: where results are looked for.
    """
    counting = [result for result in stored_results(folders) if result.counts]
    seen = {result.path: bench for result in counting if (bench := _bench_of(result, cell, root)) is not None}
    # What answered last is the arm in question; a rehearsal on emulators takes no real arm's place.
    own = sorted(
        (result for result in counting if result.path in seen),
        key=lambda one: (seen[one.path].simulated is not True, one.measured, one.changed_s),
    )
    present = reduce(BenchSeen.updated, (seen[result.path] for result in own), NOTHING_SEEN)
    why_not = {result.path: seen[result.path].why_another_arm(present) for result in own}
    kept = [result for result in reversed(own) if not why_not[result.path]]
    remarks = [f"left out: {path.name}, {why}" for path, why in why_not.items() if why]
    unknown = [one.path.name for one in kept if "robot" not in seen[one.path].devices]
    if unknown:
        remarks.append(
            f"the robot of {', '.join(unknown)} stated no serial number: that it was this arm rests on the name of "
            "the cell"
        )
    return kept, remarks


def _bench_of(result: StoredResult, cell: str, root: Path) -> BenchSeen | None:
    """Return the bench that a result was measured on; None where it is of another cell, or nobody can tell."""
    for run in result.runs:
        try:
            meta = RunReader(root / run, Accept.UNCHECKED).meta
        except StorageError:
            continue
        return seen_by_run(meta) if meta.get("cell") == cell else None
    return None


def given_results(paths: Iterable[Path]) -> list[StoredResult]:
    """Return results at somebody's word.

    Raises:
        UsageError: a file is none.
    """
    found = []
    for path in paths:
        result = stored_result(path)
        if result is None:
            raise UsageError(f"{path}: is not a result, or cannot be read")
        found.append(result)
    return found


def trend_of(
    arm: str, results: Sequence[StoredResult], baseline: Path | None = None, remarks: Sequence[str] = ()
) -> Trend:
    """Return what the results of one arm say over time.

    Args:
        arm: how it is called.
        results: in any order; of several systems, those of the system of the newest one count.
        baseline: what the others are held against; None for the oldest.
        remarks: what a reader has to know beforehand.

    Raises:
        UsageError: there are fewer than two, one cannot be read, or the baseline is none of them.
    """
    ordered = sorted(results, key=lambda one: (one.measured, one.changed_s))
    kind = ordered[-1].kind if ordered else ""
    same = tuple(one for one in ordered if one.kind == kind)
    if len(same) < 2:
        raise UsageError(
            f"{arm} has {counted(len(same), 'result')}: a trend needs at least two; measure again, or name results "
            f"from elsewhere after the cell file{''.join(f'; {text}' for text in remarks)}"
        )
    number = _number_of(baseline, same)
    said = list(remarks)
    if len(same) < len(ordered):
        said.append(f"{counted(len(ordered) - len(same), 'result')} of another kind than the newest left out")
    if kind == "catseye-result":
        maps = [read_result(one.path) for one in same]
        found = courses_of_scara(same, maps, number)
        origin = joined([one.provenance.origin for one in maps])
        return Trend(arm, same, number, found.courses, found.figures, (*said, *found.remarks), origin)
    said.append("all results count as independent: nothing is known of what they share")
    if kind == "catseye-serial-arm":
        arms = [read_serial_arm(one.path) for one in same]
        courses, origins = courses_of_serial_arm(arms, number), [one.origin for one in arms]
    else:
        tests = [read_resolution(one.path) for one in same]
        courses = courses_of_resolution(tests, number)
        origins = [one.provenance.origin for one in tests if one.provenance is not None]
    return Trend(arm, same, number, courses, (), tuple(said), joined(origins))


def _number_of(baseline: Path | None, results: Sequence[StoredResult]) -> int:
    if baseline is None:
        return 0
    for number, one in enumerate(results):
        if one.path.absolute() == baseline.absolute() or str(baseline) == one.path.name:
            return number
    names = ", ".join(one.path.name for one in results)
    raise UsageError(f"{baseline} is not a result of this arm; there are {names}")
