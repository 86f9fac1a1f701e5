"""Checking that a run is what was written."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from catseye.app.errors import StorageError
from catseye.app.store.chunks import recording_faults, unfinished_recordings
from catseye.app.store.lock import is_being_written
from catseye.app.store.reader import Accept, RunReader, Status
from catseye.app.store.seal import APP_LOG, DATABASE, WIRE_LOG, Manifest
from catseye.app.store.soundness import against_manifest, integrity
from catseye.procedures.kit.records import Json


@dataclass(frozen=True)
class Verification:
    """What a check found.

    Attributes:
        status: how the run ended.
        sealed: it has a manifest that can be read.
        problems: what contradicts the promise of the store; empty for a sound run.
        notes: what is worth knowing and no fault of the record.
    """

    status: Status
    sealed: bool
    problems: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def ok(self) -> bool:
        """The run is what was written."""
        return not self.problems


def verify(path: Path) -> Verification:
    """Check manifest, database and completeness of a run.

    Raises:
        StorageError: the run cannot be read at all.
    """
    reader = RunReader(path, Accept.UNCHECKED)
    status = reader.status
    manifest, found = against_manifest(path)
    notes = [] if manifest or found else [_why_unsealed(path, status)]
    notes += _missing_logs(manifest)
    problems = [*found, *(f"{DATABASE}: {text}" for text in integrity(path / DATABASE))]
    for check in (_check_events, _check_rows, _check_recordings, RunReader.misfits):
        try:
            problems += check(reader)
        except StorageError as error:
            problems.append(str(error))
    return Verification(
        status, manifest is not None, tuple(problems), tuple(notes + ([] if problems else _losses(reader)))
    )


def _why_unsealed(path: Path, status: Status) -> str:
    if is_being_written(path):
        return "not sealed: it is under way"
    if status == "died":
        return "not sealed: its process died before it was closed"
    return "not sealed: the process ended between the closing record and the manifest"


def _missing_logs(manifest: Manifest | None) -> list[str]:
    """Return the logs that a sealed run should have; each is made with it."""
    if manifest is None:
        return []
    return [
        f"{name} is not sealed with the run: at its end there was none, or no plain file, at that name"
        for name in (WIRE_LOG, APP_LOG)
        if name not in manifest.files
    ]


def _check_events(reader: RunReader) -> list[str]:
    numbers = [event.seq for event in reader.events()]
    return [] if numbers == list(range(1, len(numbers) + 1)) else ["events: numbers are missing"]


def _check_rows(reader: RunReader) -> list[str]:
    steps = {(step.step_id, step.attempt): step.row_count for step in reader.steps()}
    stored: Counter[tuple[Json, Json]] = Counter()
    problems = []
    for table in [each.name for each in reader.tables()]:
        found: Counter[tuple[Json, Json]] = Counter()
        for row in reader.rows(table):
            key = (row["step_id"], row["attempt"])
            found[key] += 1
            if row["seq"] != found[key]:
                problems.append(f"{table}: row {found[key]} of step {key[0]} is missing")
        problems += [
            f"{table}: rows of step {key[0]}, which is not done" for key in found if key not in steps
        ]
        stored += found
    lost = [key[0] for key, count in steps.items() if stored[key] != count]
    return problems + [f"step {step_id} does not have all of its rows" for step_id in lost]


def _check_recordings(reader: RunReader) -> list[str]:
    return recording_faults(reader.path, reader.recordings(), _done(reader))


def _done(reader: RunReader) -> set[tuple[str, int]]:
    return {(step.step_id, step.attempt) for step in reader.steps()}


def _losses(reader: RunReader) -> list[str]:
    notes = unfinished_recordings(reader.path, _done(reader))
    for event in reader.events():
        if event.kind == "run-ended" and event.data.get("wire_lines_cut"):
            notes.append(f"wire.log was cut: {event.data['wire_lines_cut']} lines are not in it")
        if event.kind == "step-dropped":
            notes.append(f"an attempt at step {event.data['step_id']} was dropped: {event.data.get('error')}")
    return notes
