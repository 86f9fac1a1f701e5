"""How to go on with a run that did not come to its end."""

import shlex
from contextlib import suppress
from pathlib import Path

from catseye.app.cli.output import note
from catseye.app.errors import StorageError
from catseye.app.store.reader import Accept, RunReader
from catseye.app.store.resumable import why_not_resumable


def say_how_to_go_on(path: Path) -> None:
    """Name the command that resumes a run, where its record has nothing against it."""
    # A disk that is full or gone has told its own story.
    with suppress(StorageError):
        if not why_not_resumable(RunReader(path, Accept.UNCHECKED)):
            command = shlex.join(("catseye", "resume", str(path)))
            note(f"when the cause is removed, go on with: {command}")
