"""Whether an interrupted run can go on, as far as its own record says."""

from collections.abc import Mapping
from typing import Any, Final

from catseye.app.store.reader import RunReader

MOVED: Final = "reflectors-moved"
"""Kind of the event that says that the bench is no longer the one of the points: the run never goes on."""

SET_UP_LOST: Final = "set-up-lost"
"""Kind of the event that says the same of a run that has it set up anew, and goes on."""

REJECTED: Final = "rejected"
"""Key of the closing record: what is stored is no use, and the run never goes on."""

_NEEDED = ("configuration", "configuration_file", "params", "aim", "aimed", "clock_speed", "plan_sha256")


def why_not_resumable(reader: RunReader) -> str:
    """Return why a run cannot go on; empty when its record has nothing against it."""
    name = reader.path.name
    match reader.status:
        case "complete":
            return f"{name} is complete: there is nothing to continue; start a new run"
        case "running":
            return f"{name} is under way: join it with: catseye attach {name}"
    ended = [event for event in reader.events() if event.kind == "run-ended"]
    if ended and ended[-1].data.get(REJECTED):
        return (
            f"the measurement of {name} was rejected: {ended[-1].data.get('text')}; what it has stored would be "
            "rejected again: remove the cause and start a new run"
        )
    moved = [event for event in reader.events() if event.kind == MOVED]
    if moved:
        return (
            f"the reflectors of {name} were moved ({moved[-1].time_utc[:19]}): its points and new ones would not "
            "belong together; search again and start a new run; the points so far stay usable"
        )
    return _missing(name, reader.meta)


def writer_of(meta: Mapping[str, Any]) -> str:
    """Return the version of the program that began a run."""
    software: Any = meta.get("software") or {}
    return str(software.get("catseye", "of an unknown version"))


def _missing(name: str, meta: Mapping[str, Any]) -> str:
    missing = [key for key in _NEEDED if key not in meta]
    if not missing:
        return ""
    if "configuration" in missing:
        return f"{name} died before it had stored its configuration, and has no points: start a new run"
    return (
        f"{name} was written by catseye {writer_of(meta)}, which did not store what going on needs "
        f"({', '.join(missing)}): start a new run; the points so far stay usable"
    )
