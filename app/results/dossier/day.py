"""The day of a cell: the stages of its way with what they found, the runs and files that they come from."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from catseye.app.cell.model import Cell
from catseye.app.errors import CatseyeError, UsageError
from catseye.app.results.dossier.validated import worth_of_validation
from catseye.app.results.dossier.worth import Worth, is_result, worth_of_result
from catseye.app.results.found import found_sections
from catseye.app.results.model import Origin, Sign, Statement
from catseye.app.results.numbers import counted
from catseye.app.results.origin import joined
from catseye.app.results.readiness.cell_runs import runs_of_cell
from catseye.app.results.readiness.stages import CellStage
from catseye.app.results.readiness.survey import Survey
from catseye.app.results.resolution.recorded_runs import holds_tests
from catseye.app.results.runs.records import Measurement, Sources
from catseye.app.results.runs.run_source import cell_of_run, origin_of_run
from catseye.app.results.runs.trace import sources_of
from catseye.app.results.scara.measurement import measurement_of
from catseye.app.store.reader import Accept, RunReader
from catseye.app.store.unverified import taken_as_it_is
from catseye.calibration.core.errors import CalibrationError
from catseye.procedures.kit.dossier import DOSSIER

_VALIDATE: Final = "validate"


@dataclass(frozen=True)
class StageOfDay:
    """A stage with what it found.

    Attributes:
        stage: its state, runs and files.
        worth: what is said of it.
        stale: newest complete run of a procedure that does not count any more; empty for none.
    """

    stage: CellStage
    worth: Worth
    stale: str = ""

    @property
    def runs(self) -> tuple[str, ...]:
        """Names of the runs that it is shown by."""
        return (self.stale,) if self.stale else self.stage.runs


@dataclass(frozen=True)
class Day:
    """Everything that a dossier joins.

    Attributes:
        cell: as its newest run has it.
        stages: of its way, in order.
        measurement: what their runs say about how it was measured.
        sources: what the page is made with, and the digests of the files of the stages.
        origin: of everything together.
    """

    cell: Cell
    stages: tuple[StageOfDay, ...]
    measurement: Measurement
    sources: Sources
    origin: Origin


def judged_at(root: Path, cell: str) -> datetime:
    """Return the UTC time at which a cell's newest run began: what was warm or aligned then counts.

    Raises:
        StorageError: the run is damaged.
        UsageError: the cell has no runs.
    """
    newest = runs_of_cell(root, cell, datetime.now(UTC)).newest
    if newest is None:
        raise UsageError(f"{root} holds no run of cell {cell}: measure first, or say --runs FOLDER")
    began = RunReader(root / newest.name, Accept.UNCHECKED).events()[0]
    return datetime.fromisoformat(began.time_utc)


def day_of(survey: Survey, root: Path, terms: Accept) -> Day:
    """Return the day of a cell that was surveyed.

    Args:
        root: folder of the runs.
        terms: whether runs that were changed after their end are taken.

    Raises:
        StorageError: a run is damaged, or was changed and is not taken.
        UsageError: none of the stages has a run.
    """
    of_the_day = [stage for stage in survey.stages if stage.words[:1] != (DOSSIER,)]
    stale = {stage.name: _stale(stage, survey) for stage in of_the_day}
    names = sorted({name for stage in of_the_day for name in (*stage.runs, stale[stage.name]) if name})
    if not names:
        raise UsageError(
            f"no stage of the way of cell {survey.cell} has a complete run: there is nothing to join"
        )
    readers = {name: RunReader(root / name, terms) for name in names}
    evaluated = _evaluated(of_the_day)
    stages = tuple(
        StageOfDay(stage, _worth(stage, stale[stage.name], readers, evaluated), stale[stage.name])
        for stage in of_the_day
    )
    return _joined(stages, list(readers.values()))


def _joined(stages: tuple[StageOfDay, ...], readers: Sequence[RunReader]) -> Day:
    cell = cell_of_run(readers[-1])
    files = dict.fromkeys(path for one in stages for path in one.stage.files)
    origins = [*map(origin_of_run, readers), *(origin for one in stages for origin in one.worth.origins)]
    return Day(cell, stages, measurement_of(readers, cell), sources_of(files), joined(origins))


def _evaluated(stages: Sequence[CellStage]) -> dict[str, str]:
    """Return the stages of work on data that are done with results, by the names of their runs."""
    done = [one for one in stages if one.state == "done" and any(map(is_result, one.files))]
    return {name: one.name for one in done for name in one.runs}


def _stale(stage: CellStage, survey: Survey) -> str:
    """Return the newest complete run of a procedure none of whose runs counts."""
    run = survey.runs.last_complete(stage.name) if stage.procedure and not stage.runs else None
    return "" if run is None else run.name


def _worth(stage: CellStage, stale: str, readers: dict[str, RunReader], evaluated: dict[str, str]) -> Worth:
    """Return what is said of a stage; of one that cannot be read or compared, why."""
    try:
        if stage.procedure:
            names = (stale,) if stale else stage.runs
            found = _of_runs([readers[name] for name in names], evaluated)
            return _no_longer_counting(found) if stale else found
        if stage.words[0] == _VALIDATE and stage.files:
            return worth_of_validation(Path(stage.words[1]), readers[stage.runs[0]])
        return _of_files(filter(is_result, stage.files))
    except (CatseyeError, CalibrationError, LookupError, TypeError, ValueError) as error:
        return Worth(Sign.ATTENTION, f"cannot be stated: {error}")


def _no_longer_counting(found: Worth) -> Worth:
    """Return what a run found that does not count any more: nothing of it is in order."""
    return found if found.sign is Sign.BAD else replace(found, sign=Sign.ATTENTION)


def _of_files(paths: Iterable[Path]) -> Worth:
    """Return what result files are worth together."""
    found = [worth_of_result(path) for path in paths]
    if len(found) < 2:
        return found[0] if found else Worth()
    return Worth(
        found[-1].sign,
        "; ".join(one.figure for one in found),
        tuple(section for one in found for section in one.sections),
        tuple(table for one in found for table in one.tables),
        tuple(origin for one in found for origin in one.origins),
    )


def _of_runs(readers: Sequence[RunReader], evaluated: dict[str, str]) -> Worth:
    """Return what a run found; what is recorded to be evaluated stands with the result where there is one."""
    if not readers:
        return Worth()
    (reader,) = readers
    if reader.name in evaluated and holds_tests(reader):
        return Worth(Sign.GOOD, f"recorded; evaluated in the stage {evaluated[reader.name]}")
    with taken_as_it_is(reader):
        sections = tuple(found_sections(reader))
    statements = [block for one in sections for block in one.blocks if isinstance(block, Statement)]
    measured = Statement(Sign.GOOD, _measured(reader))
    first = next((one for one in statements if one.short), statements[0] if statements else measured)
    return Worth(first.sign, first.expanded or first.short or first.text, sections)


def _measured(reader: RunReader) -> str:
    return counted(reader.measured, "measured point") if reader.measured else "complete"
