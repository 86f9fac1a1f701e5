"""The names of runs, and the folders that have them; light enough for the completion of a shell."""

import re
from datetime import datetime
from pathlib import Path

from catseye.app.errors import StorageError

JOB = "job"
"""Key under which a run says which job of a campaign it belongs to."""

STARTED = "%Y%m%dT%H%M%SZ"
"""Format of the UTC time that a run's name begins with."""

_NAME = re.compile(r"(?P<started>\d{8}T\d{6}Z)_(?P<procedure>.+)_(?P<id>[0-9a-f]{6})")


def run_name(name: str) -> re.Match[str] | None:
    """Return the parts of a run's name (started, procedure, id); None when it is the name of something else."""
    match = _NAME.fullmatch(name)
    try:
        if match is not None:
            start_of(match)
    except ValueError:
        # No such day, or no such time.
        return None
    return match


def start_of(match: re.Match[str]) -> datetime:
    """Return the UTC time in a run's name."""
    # As ISO 8601 in its short form: strptime is slow for the thousands of names of each look.
    return datetime.fromisoformat(match["started"])


def run_folders(root: Path) -> list[tuple[Path, re.Match[str]]]:
    """Return the folders of runs below a directory with the parts of their names, oldest first; none is opened.

    Raises:
        StorageError: the directory cannot be listed.
    """
    try:
        paths = sorted(root.iterdir()) if root.is_dir() else []
        return [(path, match) for path in paths if path.is_dir() and (match := run_name(path.name))]
    except OSError as error:
        raise StorageError(
            f"{root} cannot be listed: {error}; choose another directory with --runs"
        ) from error
