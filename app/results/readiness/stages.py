"""The way from an unknown bench to a validated result, and how far a cell has come on it."""

import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path
from typing import Final, Literal

from catseye.app.results.numbers import age_text
from catseye.app.results.readiness.cell_runs import CellRun, CellRuns
from catseye.app.results.readiness.headline import NO_HEADLINES, Headline, Headlines, Written
from catseye.app.results.readiness.need import Need
from catseye.app.store.seal import DATABASE
from catseye.procedures.kit.procedure import Analysis, Asked, Procedure, Stage

State = Literal["done", "failed", "next", "later", "left out"]

NO_RESULT: Final = "RESULT"
"""Stands in a command where the way has led to no result yet."""

_OUTPUT: Final = "-o"
_RESULT: Final = "{result}"
_RUNS: Final = "{runs}"


@dataclass(frozen=True)
class Place:
    """Where the work of a cell is done.

    Attributes:
        cell: its file.
        arm: of its robot; empty where it describes none by name.
        runs: words that name the folder of runs; empty for the usual one.
        folder: what is written goes there.
        folders: where files of analyses are looked for.
        runs_in: folder of the runs.
        headlines: what stands for finished stages.
        beside: models that results are held against, by the name of the run that they were made from.
        taken: names of the runs whose values the cell file holds.
    """

    cell: Path
    arm: str = ""
    runs: tuple[str, ...] = ()
    folder: Path = Path()
    folders: Sequence[Path] = ()
    runs_in: Path = Path()
    headlines: Headlines = NO_HEADLINES
    beside: Mapping[str, Path] = field(default_factory=dict[str, Path])
    taken: frozenset[str] = frozenset()


@dataclass(frozen=True)
class CellStage:
    """One stage of the way of a cell.

    Attributes:
        name: of the procedure or command.
        procedure: it is a procedure on the bench; False is work on stored data.
        state: done; failed, since what was wanted of work on stored data is not reached; the next one; one for
            later; or left out.
        text: by what it is done, or what it is for.
        command: what does it, as somebody types it; `resume` where an interrupted run of it can go on.
        found: the figure that it gave, or did not reach; empty for none.
        lost: why it was done and is so no longer, in a few words; empty otherwise.
        words: of the command; `{name}` stands for what is asked.
        asks: what a person has to give before.
        runs: names of the run that it was, or of those that it works on.
        files: that it gave.
        changes_cell: its command changes the cell file, and asks before.
        params: of a procedure, as a campaign gives them: name=value.
        limits: of what it finds, as a campaign gives them.
        results: of the files, those that later stages work on; none that stands beside them.
    """

    name: str
    procedure: bool
    state: State
    text: str
    command: str
    found: str = ""
    lost: str = ""
    words: tuple[str, ...] = ()
    asks: tuple[Asked, ...] = ()
    runs: tuple[str, ...] = ()
    files: tuple[Path, ...] = ()
    changes_cell: bool = False
    params: tuple[str, ...] = ()
    limits: tuple[str, ...] = ()
    results: tuple[Path, ...] = ()

    @property
    def output(self) -> Path | None:
        """The file that the command writes; None of one that writes none."""
        return Path(self.words[self.words.index(_OUTPUT) + 1]) if _OUTPUT in self.words else None

    @property
    def shown(self) -> Path | None:
        """The file by which it is done; else the one that its command writes."""
        return self.files[-1] if self.files else self.output

    def writing(self, output: Path) -> "CellStage":
        """Return the stage with a command that writes another file."""
        place = self.words.index(_OUTPUT) + 1
        return replace(self, words=(*self.words[:place], str(output), *self.words[place + 1 :]))


def stages_of(
    procedures: Iterable[Procedure],
    runs: CellRuns,
    needs: Mapping[str, list[Need]],
    bases: Mapping[str, CellRun | None],
    results: Mapping[str, Path],
    place: Place,
) -> list[CellStage]:
    """Return the stages of the ways that a cell is made for, at most one of them the next.

    Args:
        bases: runs that plans are made from now, by the procedure that makes such runs.
        results: by the name of the run that they hold.
        place: where the work is done.
    """
    procedures = list(procedures)
    counting = _Counting(runs, bases, {each.name: each.stage for each in procedures if each.stage})
    steps: list[tuple[Stage, _Step]] = []
    for procedure in procedures:
        if procedure.stage is not None:
            steps.append((procedure.stage, _on_the_bench(procedure, procedure.stage, counting, place)))
    for analysis, names in _works_on(procedures).items():
        steps.append((analysis.stage, _on_data(analysis, names, counting, results, place)))
    shut = _ways_shut(procedures, needs)
    open_steps = [(stage, step) for stage, step in steps if stage.way not in shut]
    ordered = [step for _, step in sorted(open_steps or steps, key=lambda each: each[0].order)]
    return list(_with_states(_with_result(ordered, place), runs, needs))


def _ways_shut(procedures: Iterable[Procedure], needs: Mapping[str, list[Need]]) -> set[str]:
    """Return the ways for which the cell file has not what any of their procedures needs."""
    stated: dict[str, bool] = {}
    for each in procedures:
        if each.stage is not None:
            lacks = any(
                need.what == "cell file" and need.met == "missing" for need in needs.get(each.name, [])
            )
            stated[each.stage.way] = stated.get(each.stage.way, False) or not lacks
    return {way for way, there in stated.items() if not there}


@dataclass(frozen=True)
class _Step:
    """A stage before its state is known.

    Attributes:
        name: of the procedure or command.
        purpose: what it is for.
        done: by what it is done; empty for not yet.
        words: of the command that does it; `{result}` stands for the results that the way has led to so far.
        found: the figure that it gave.
        failed: it was done, and what was wanted is not reached.
        lost: why the run of before no longer counts, in a few words; empty where there is none.
        asks: what a person has to give before.
        writes: name of a file that says that it is done, where it is newer than the results of the way.
        joins: that file has to be newer than all that the way has given.
        results: that it gave.
        works_on: procedures of whose runs it works on one, where there is none yet; empty for none.
        on_bench: a procedure does it; otherwise a command, which may have the name of one.
        runs: names of the run that it was, or of those that it works on.
        files: that it gave.
        optional: the way leads on without it.
        changes_cell: its command changes the cell file.
    """

    name: str
    purpose: str
    done: str
    words: tuple[str, ...]
    found: str = ""
    failed: bool = False
    lost: str = ""
    asks: tuple[Asked, ...] = ()
    writes: str = ""
    joins: bool = False
    results: tuple[Path, ...] = ()
    works_on: tuple[str, ...] = ()
    on_bench: bool = False
    runs: tuple[str, ...] = ()
    files: tuple[Path, ...] = ()
    optional: bool = False
    changes_cell: bool = False


@dataclass(frozen=True)
class _Counting:
    """Which runs of a cell count as stages of the way.

    Attributes:
        bases: runs that plans are made from now, by procedure.
        stages: by procedure.
    """

    runs: CellRuns
    bases: Mapping[str, CellRun | None]
    stages: Mapping[str, Stage]

    def run(self, name: str) -> CellRun | None:
        """Return the run by which a stage is done; None while it is not."""
        stage = self.stages.get(name)
        if name in self.bases:
            run = self.bases[name]
            return None if run is None or run.void else run
        if stage is None:
            return self.runs.last_counting(name, None)
        before = self.run(stage.since) if stage.since else None
        if stage.since and before is None:
            return None
        renewal = self.runs.last_complete(stage.renewed_by) if stage.renewed_by else None
        return self.runs.last_counting(name, stage.fresh_for_s, after=before or renewal)

    def covers(self, name: str, before: CellRun) -> bool:
        """Return whether a run of a stage was made after another one, which is no longer needed then."""
        run = self.run(name) if name else None
        return run is not None and run.age_s <= before.age_s


def _on_the_bench(procedure: Procedure, stage: Stage, counting: _Counting, place: Place) -> _Step:
    run = counting.run(procedure.name)
    before = counting.runs.last_complete(procedure.name) if run is None else None
    covered = before is not None and counting.covers(stage.covered_by, before)
    last = counting.runs.last(procedure.name)
    words: tuple[str, ...] = ("run", procedure.name, "--cell", str(place.cell), *place.runs)
    if last is not None and last.resumable and not last.void:
        words = ("resume", last.name, *place.runs)
    found = None if run is None else place.headlines.of_run(place.runs_in / run.name)
    failed = found is not None and not found.holds
    return _Step(
        procedure.name,
        stage.purpose,
        stage.covered if covered else "" if failed else _by(run),
        words,
        "" if found is None else found.text,
        failed,
        "" if before is None else before.void,
        on_bench=True,
        runs=() if run is None else (run.name,),
        optional=stage.optional,
    )


def _works_on(procedures: Iterable[Procedure]) -> dict[Analysis, list[str]]:
    """Return each analysis once, with the names of the procedures on whose runs it works."""
    found: dict[Analysis, list[str]] = {}
    for procedure in procedures:
        for analysis in procedure.analyses:
            found.setdefault(analysis, []).append(procedure.name)
    return found


def _on_data(
    analysis: Analysis,
    names: Sequence[str],
    counting: _Counting,
    results: Mapping[str, Path],
    place: Place,
) -> _Step:
    runs = [run for name in names if (run := counting.run(name)) is not None]
    holding = place.beside if analysis.stands_beside else results
    made = tuple(dict.fromkeys(holding[run.name] for run in runs if run.name in holding))
    # Each run has a result of its own: the first one without is the next to be worked on.
    waiting = [run for run in runs if run.name not in holding] or runs
    run_id = waiting[0].id if waiting else "RUN"
    done = ""
    found: Headline | None = None
    gives_model = analysis.writes_result or analysis.stands_beside
    if gives_model and runs and all(run.name in holding for run in runs):
        done = ", ".join(map(str, made))
        found = place.headlines.of_result(made[-1]) if analysis.writes_result else None
    if analysis.changes_cell and runs and all(run.name in place.taken for run in runs):
        done = f"in {place.cell.name}"
    return _Step(
        analysis.called or analysis.command,
        analysis.stage.purpose,
        done,
        (analysis.command, *_filled(analysis, run_id, place)),
        "" if found is None else found.text,
        asks=analysis.asks,
        writes=analysis.writes.format(run=run_id, name=place.cell.stem) if runs else "",
        joins=analysis.joins,
        results=made if analysis.writes_result else (),
        works_on=() if runs else tuple(names),
        runs=tuple(run.name for run in runs),
        files=made if gives_model else (),
        optional=analysis.stage.optional,
        changes_cell=analysis.changes_cell,
    )


def _filled(analysis: Analysis, run_id: str, place: Place) -> Iterator[str]:
    """Yield the words of a command with what is known; what is asked, and the results, stay as they are."""
    open_yet = {_RESULT, *(f"{{{asked.name}}}" for asked in analysis.asks)}
    folder = "" if place.folder == Path() else f"{place.folder}/"
    known = {
        "run": run_id,
        "folder": folder,
        "cell": str(place.cell),
        "name": place.cell.stem,
        "arm": place.arm or "ARM",
    }
    for word in analysis.usage:
        if word == _RUNS:
            yield from place.runs
        else:
            yield word if word in open_yet else word.format(**known)


def _newer(name: str, folders: Sequence[Path], than: Sequence[Path]) -> Path | None:
    """Return a file that is newer than all others; None without one, or without others."""
    found = (folder / name for folder in folders)
    return next((path for path in found if than and _changed(path) >= max(map(_changed, than))), None)


def _changed(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0


def _with_result(steps: Sequence[_Step], place: Place) -> Iterable[_Step]:
    """Yield the stages with the results that the way has led to in their commands."""
    results: tuple[Path, ...] = ()
    given: list[Path] = []
    for step in steps:
        results = step.results or results
        known = tuple(map(str, results)) or (NO_RESULT,)
        words = (known if word == _RESULT else (word,) for word in step.words)
        step = replace(step, words=tuple(chain.from_iterable(words)))
        than = given if step.joins else results
        newer = _newer(step.writes, place.folders, than) if step.writes and not step.done else None
        step = step if newer is None else _written(step, newer, results, place)
        given += (*(place.runs_in / name / DATABASE for name in step.runs), *step.files)
        yield step


def _written(step: _Step, file: Path, results: tuple[Path, ...], place: Place) -> _Step:
    """Return a stage of work on data that has written its file."""
    runs = tuple(place.runs_in / name for name in step.runs)
    found = place.headlines.of_written(Written(step.words[0], file, results, runs))
    if found is None:
        return replace(step, done=str(file), files=(file,))
    done = str(file) if found.holds else ""
    return replace(step, done=done, found=found.text, failed=not found.holds, files=(file,))


def _with_states(
    steps: Iterable[_Step], runs: CellRuns, needs: Mapping[str, list[Need]]
) -> Iterable[CellStage]:
    steps, open_yet = list(steps), True
    for number, step in enumerate(steps):
        state: State = "done"
        text = step.done or _why_open(step)
        on_bench = step.on_bench and step.name in needs
        gone_on = any(later.done and not later.optional for later in steps[number + 1 :])
        if not step.done and on_bench and (why := _cannot(needs[step.name])):
            state, text = "left out", why
        elif step.failed and not step.on_bench:
            # Doing it again changes nothing, and nothing waits for it.
            state = "failed"
        elif not step.done and step.works_on and all(_cannot(needs[name]) for name in step.works_on):
            one = " or ".join(step.works_on)
            state, text = "left out", f"it takes a run of {one}, which this cell cannot make"
        elif not step.done and step.optional and not step.runs:
            state, text = "left out", f"optional; {text}"
        elif (
            not step.done
            and gone_on
            and (step.optional or (on_bench and (step.failed or runs.last_complete(step.name) is None)))
        ):
            # Whoever went on without it has decided so.
            state, text = "left out", f"gone on without it; {text}"
        elif not step.done:
            state, open_yet = ("next" if open_yet else "later"), False
        found = step.found if state in {"done", "failed"} else _why_open(step) if step.failed else ""
        yield CellStage(
            step.name,
            on_bench,
            state,
            text,
            _typed(step),
            found,
            "" if step.done else step.lost,
            step.words,
            step.asks,
            step.runs,
            step.files,
            step.changes_cell,
            results=step.results,
        )


def _why_open(step: _Step) -> str:
    if step.failed:
        return f"not reached: {step.found}"
    return f"its run no longer counts, {step.lost}; {step.purpose}" if step.lost else step.purpose


def _typed(step: _Step) -> str:
    """Return a command as somebody types it; what is asked stands there in capitals."""
    names = {f"{{{asked.name}}}": asked.name.upper() for asked in step.asks}
    return shlex.join(("catseye", *(names.get(word, word) for word in step.words)))


def _cannot(needs: list[Need]) -> str:
    """Return why a procedure cannot be planned on this cell at all; empty when it can."""
    return next(
        (need.text for need in needs if need.what in {"plan", "cell file"} and need.met == "missing"), ""
    )


def _by(run: CellRun | None) -> str:
    return "" if run is None else f"run {run.id}, {age_text(run.age_s)}"
