"""What the limits of a stage judge: what its run keeps, the result that it wrote, or what it said."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from catseye.app.campaign.model import StageEntry
from catseye.app.errors import CatseyeError
from catseye.app.files.documents import LARGEST_RESULT_BYTES, parse_json, read_document
from catseye.app.results.readiness.stages import CellStage
from catseye.app.store.reader import RunReader

DocumentOfRun = Callable[[str], dict[str, Any]]
"""Returns what a run keeps, by its name, as `catseye show --json` writes it; blocks."""


def stored_document(root: Path, run: str) -> dict[str, Any]:
    """Return what a run keeps.

    Args:
        root: folder of the runs.
        run: its name.

    Raises:
        StorageError: it cannot be read, or was changed.
    """
    # What evaluates runs takes a second to import.
    from catseye.app.results.found import found_sections
    from catseye.app.results.runs.documents import run_document

    reader = RunReader(root / run)
    return run_document(reader, found_sections(reader)).model_dump(mode="json")


def document_file(folder: Path, entry: StageEntry) -> Path:
    """Return where a job keeps the JSON that the command of a stage has written."""
    return folder / f"stage-{entry.name}.json"


def document_of(
    entry: StageEntry, stage: CellStage | None, of_run: DocumentOfRun, folder: Path | None
) -> object:
    """Return what the limits of a stage judge.

    Args:
        stage: as the day's list has it; None of one with a command of its own.
        folder: of the job; None outside of one.

    Returns:
        None where there is nothing that can be read, or nothing is to be judged.
    """
    if not entry.limit:
        return None
    try:
        if stage is not None and stage.procedure:
            return of_run(stage.runs[-1]) if stage.runs else None
        written = [path for path in (() if stage is None else stage.files) if path.suffix == ".json"]
        if not written and folder is not None:
            written = [document_file(folder, entry)]
        return (
            parse_json(read_document(written[-1], largest_bytes=LARGEST_RESULT_BYTES), written[-1])
            if written
            else None
        )
    except CatseyeError:
        # The limit says that there is no such value.
        return None
