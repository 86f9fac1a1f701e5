"""Result files of folders: which there are, newest first."""

import stat
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Final, Generic, TypeVar

from catseye.app.errors import UsageError

ResultT = TypeVar("ResultT")
ResultT_co = TypeVar("ResultT_co", covariant=True)

_BEGINNING: Final = 4096


@dataclass(frozen=True)
class ResultFile(Generic[ResultT_co]):
    """One result file.

    Attributes:
        path: of the file.
        changed_utc: when it was written.
        result: what it holds; None when it cannot be read.
        fault: why it cannot be read.
    """

    path: Path
    changed_utc: datetime
    result: ResultT_co | None
    fault: str = ""


class ResultFiles(Generic[ResultT]):
    """Results of folders, read anew only where a file has changed.

    Args:
        folders: that are looked at; not what is below them.
        readers: what reads a file, by the name of its format without the version.
    """

    def __init__(self, folders: Iterable[Path], readers: Mapping[str, Callable[[Path], ResultT]]) -> None:
        self._folders = tuple(dict.fromkeys(folder.absolute() for folder in folders))
        self._readers = {f"{name}/".encode(): reader for name, reader in readers.items()}
        self._known: dict[Path, tuple[tuple[int, int], ResultFile[ResultT] | None]] = {}

    def look(self) -> list[ResultFile[ResultT]]:
        """Return the result files that there are now, newest first, those that cannot be read at the end.

        Other files are passed over.
        """
        seen: dict[Path, tuple[tuple[int, int], ResultFile[ResultT] | None]] = {}
        for path in (path for folder in self._folders for path in folder.glob("*.json")):
            try:
                facts = path.stat()
            except OSError:
                continue
            if not stat.S_ISREG(facts.st_mode):
                continue
            stamp = facts.st_mtime_ns, facts.st_size
            known = self._known.get(path)
            seen[path] = (
                known if known is not None and known[0] == stamp else (stamp, self._read(path, stamp[0]))
            )
        self._known = seen
        found = [file for _, file in seen.values() if file is not None]
        return sorted(
            found, key=lambda file: (file.result is not None, file.changed_utc, file.path.name), reverse=True
        )

    def _read(self, path: Path, changed_ns: int) -> ResultFile[ResultT] | None:
        changed = datetime.fromtimestamp(changed_ns / 1e9, UTC)
        try:
            with path.open("rb") as stream:
                beginning = stream.read(_BEGINNING)
        except OSError as error:
            return ResultFile(path, changed, None, f"{path} cannot be read: {error.strerror}")
        reader = next((reader for sign, reader in self._readers.items() if sign in beginning), None)
        if reader is None:
            return None
        try:
            return ResultFile(path, changed, reader(path))
        except UsageError as error:
            return ResultFile(path, changed, None, str(error))
