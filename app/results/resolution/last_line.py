"""Whether a text file ends with a whole line: one without end may have been cut in the midst of a number."""

import os
from pathlib import Path

from catseye.app.errors import UsageError


def is_whole(path: Path) -> bool:
    """Return whether the last line of a file that is not empty has an end; Parquet and pipes count as whole."""
    if path.suffix.lower() == ".parquet" or not path.is_file():
        return True
    with path.open("rb") as file:
        file.seek(-1, os.SEEK_END)
        return file.read() in {b"\n", b"\r"}


def require_whole(path: Path) -> None:
    """Refuse a file whose last line has no end.

    Raises:
        UsageError: names file and line.
    """
    if is_whole(path):
        return
    line = len(path.read_bytes().splitlines())
    raise UsageError(
        f"{path}:{line}: the last line has no end, so its last number may have been cut: copy the file again, or "
        "end the line if it is whole"
    )
