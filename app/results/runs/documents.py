"""Stored runs as `catseye runs`, `show` and `verify` write them with --json."""

from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel, Field

from catseye.app.errors import StorageError
from catseye.app.results.model import Section, Table
from catseye.app.results.runs.timeline import timeline
from catseye.app.results.said import Said, said_in
from catseye.app.store.catalog import RunSummary
from catseye.app.store.reader import Accept, RunReader
from catseye.app.store.resumable import why_not_resumable
from catseye.app.store.verify import Verification

_OVER_OR_BUSY = frozenset({"complete", "running", "damaged"})


class RunEntry(BaseModel):
    """A line of the list of runs.

    Attributes:
        run: its name.
        id: six hexadecimal digits.
        procedure: what was run.
        started: UTC time as in the name, yyyymmddThhmmssZ.
        status: how it ended; damaged when it cannot be read.
        path: its directory.
        resumable: it can go on.
    """

    run: str
    id: str
    procedure: str
    started: str
    status: str
    path: str
    resumable: bool


class EventEntry(BaseModel):
    """Something that happened, as it is stored."""

    t: str
    kind: str
    data: dict[str, Any]


class MomentEntry(BaseModel):
    """A line of the timeline."""

    t: str
    text: str


class RunDocument(BaseModel):
    """What a run keeps.

    Attributes:
        run: its name.
        status: how it ended.
        exit_code: of the process; None before its end.
        meta: what it says about itself.
        counts: rows by table.
        results: of steps that return more than rows, by step.
        found: rows of the tables of what the run found, by table; empty where its procedure has none.
        said: what the run found, in sentences.
        events: everything that happened.
        prompts: questions and answers.
        resumable: it can go on.
        unverified: what speaks against a run that was changed after its end.
        story: the timeline.
    """

    run: str
    status: str
    exit_code: int | None
    meta: dict[str, Any]
    counts: dict[str, int]
    results: dict[str, Any]
    found: dict[str, list[dict[str, Any]]] = {}
    said: tuple[Said, ...] = ()
    events: list[EventEntry]
    prompts: list[dict[str, Any]]
    resumable: bool
    unverified: list[str] = Field(default=[], exclude_if=lambda texts: not texts)
    story: list[MomentEntry]


class VerificationDocument(BaseModel):
    """Whether a run is what was written.

    Attributes:
        run: its name.
        sound: nothing contradicts the promise of the store.
        sealed: it has a manifest that can be read.
        problems: what contradicts it.
        notes: what is worth knowing and no fault of the record.
    """

    run: str
    sound: bool
    sealed: bool
    problems: tuple[str, ...]
    notes: tuple[str, ...]


def run_entry(summary: RunSummary) -> RunEntry:
    """Return a run's line in the list."""
    return RunEntry(
        run=summary.name,
        id=summary.id,
        procedure=summary.procedure,
        started=summary.started,
        status=summary.status,
        path=str(summary.path),
        resumable=_resumable(summary),
    )


def run_document(reader: RunReader, found: Sequence[Section] = ()) -> RunDocument:
    """Return what a run keeps.

    Args:
        found: what the run found, whose tables and sentences are listed.
    """
    counted = ("steps", *(table.name for table in reader.tables()), "events")
    return RunDocument(
        run=reader.path.name,
        status=reader.status,
        exit_code=reader.exit_code,
        meta=dict(reader.meta),
        counts={name: reader.count(name) for name in counted},
        results={step.step_id: step.result for step in reader.steps() if step.row_count == 0 and step.result},
        found={table.key: _rows(table) for table in _tables(found)},
        said=said_in(found),
        events=[EventEntry(t=event.time_utc, kind=event.kind, data=event.data) for event in reader.events()],
        prompts=reader.prompts(),
        resumable=not why_not_resumable(reader),
        unverified=list(reader.unverified),
        story=[MomentEntry(t=moment.time_utc, text=moment.text) for moment in timeline(reader)],
    )


def _tables(sections: Sequence[Section]) -> list[Table]:
    return [block for one in sections for block in one.blocks if isinstance(block, Table)]


def _rows(table: Table) -> list[dict[str, Any]]:
    keys = [column.key for column in table.columns]
    return [dict(zip(keys, row, strict=True)) for row in table.rows]


def verification_document(run: str, verification: Verification) -> VerificationDocument:
    """Return what a check of a run came to."""
    return VerificationDocument(
        run=run,
        sound=verification.ok,
        sealed=verification.sealed,
        problems=verification.problems,
        notes=verification.notes,
    )


def _resumable(summary: RunSummary) -> bool:
    if summary.status in _OVER_OR_BUSY:
        return False
    try:
        return not why_not_resumable(RunReader(summary.path, Accept.UNCHECKED))
    except StorageError:
        # The others are listed all the same; whoever opens it learns why.
        return False
