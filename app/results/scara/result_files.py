"""Result files of folders: which there are, newest first."""

import stat
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from catseye.app.errors import UsageError
from catseye.app.results.scara.result import Result, read_result

_BEGINNING: Final = 4096
_SIGN: Final = b"catseye-result/"


@dataclass(frozen=True)
class ResultFile:
    """One result file.

    Attributes:
        path: of the file.
        changed_utc: when it was written.
        result: what it holds; None when it cannot be read.
        fault: why it cannot be read.
    """

    path: Path
    changed_utc: datetime
    result: Result | None
    fault: str = ""


class ResultFiles:
    """Results of folders, read anew only where a file has changed.

    Args:
        folders: that are looked at; not what is below them.
    """

    def __init__(self, folders: Iterable[Path]) -> None:
        self._folders = tuple(dict.fromkeys(folder.absolute() for folder in folders))
        self._known: dict[Path, tuple[tuple[int, int], ResultFile | None]] = {}

    def look(self) -> list[ResultFile]:
        """Return the result files that there are now, newest first, those that cannot be read at the end.

        Other files are passed over.
        """
        seen: dict[Path, tuple[tuple[int, int], ResultFile | None]] = {}
        for path in (path for folder in self._folders for path in folder.glob("*.json")):
            try:
                facts = path.stat()
            except OSError:
                continue
            if not stat.S_ISREG(facts.st_mode):
                continue
            stamp = facts.st_mtime_ns, facts.st_size
            known = self._known.get(path)
            seen[path] = known if known is not None and known[0] == stamp else (stamp, _read(path, stamp[0]))
        self._known = seen
        found = [file for _, file in seen.values() if file is not None]
        return sorted(
            found, key=lambda file: (file.result is not None, file.changed_utc, file.path.name), reverse=True
        )


def _read(path: Path, changed_ns: int) -> ResultFile | None:
    changed = datetime.fromtimestamp(changed_ns / 1e9, UTC)
    try:
        with path.open("rb") as stream:
            beginning = stream.read(_BEGINNING)
    except OSError as error:
        return ResultFile(path, changed, None, f"{path} cannot be read: {error.strerror}")
    if _SIGN not in beginning:
        return None
    try:
        return ResultFile(path, changed, read_result(path))
    except UsageError as error:
        return ResultFile(path, changed, None, str(error))
