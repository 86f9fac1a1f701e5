"""How to go on with a run that did not come to its end."""

import shlex
from contextlib import suppress
from pathlib import Path

from catseye.app.cli.output import note
from catseye.app.errors import StorageError
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.run_events import RunEnded
from catseye.app.store.reader import Accept, RunReader
from catseye.app.store.resumable import why_not_resumable


def ended_late(path: Path) -> RunEnded:
    """Return the end of a complete run, which its process did not live to publish."""
    reader = RunReader(path)
    drives_on = any(event.data.get("on") for event in reader.events() if event.kind == "drives")
    ended = [event for event in reader.events() if event.kind == "run-ended"][-1]
    event = RunEnded(
        status="complete",
        exit_code=int(ExitCode.DONE),
        text="",
        path=str(path),
        drives_on=drives_on,
    )
    return event.stamped(ended.time_utc, path.name)


def say_how_to_go_on(path: Path) -> None:
    """Name the command that resumes a run, where its record has nothing against it."""
    # A disk that is full or gone has told its own story.
    with suppress(StorageError):
        if not why_not_resumable(RunReader(path, Accept.UNCHECKED)):
            command = shlex.join(("catseye", "resume", str(path)))
            note(f"when the cause is removed, go on with: {command}")
