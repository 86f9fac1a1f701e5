"""Result files of folders and the runs that they were made from, newest first."""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

from catseye.app.errors import ConfigError
from catseye.app.files.documents import LARGEST_RESULT_BYTES, parse_json, read_document
from catseye.app.store.run_names import run_name, start_of

_KINDS: Final = frozenset({"catseye-result", "catseye-resolution", "catseye-serial-arm"})


@dataclass(frozen=True)
class StoredResult:
    """A result file.

    Attributes:
        path: of the file.
        kind: its format without the version.
        counts: a way leads to it; a conventional model only stands beside one.
        runs: names of the runs that it was made from.
        measured: UTC time at which the first of them began; when the file was written where it names none.
        changed_s: when the file was written.
    """

    path: Path
    kind: str
    counts: bool
    runs: tuple[str, ...]
    measured: datetime
    changed_s: float

    @property
    def day(self) -> str:
        """The date of the measurement, as a table has it."""
        return f"{self.measured:%Y-%m-%d %H:%M}"


def stored_results(folders: Iterable[Path]) -> list[StoredResult]:
    """Return the result files of folders, not of the ones below them, the newest first."""
    paths = {path.absolute(): path for folder in folders if folder.is_dir() for path in folder.glob("*.json")}
    found = [result for path in paths.values() if (result := stored_result(path)) is not None]
    return sorted(found, key=lambda one: (-one.changed_s, one.path))


def stored_result(path: Path) -> StoredResult | None:
    """Return what a file says of itself; None of one that is no result."""
    try:
        data = parse_json(read_document(path, largest_bytes=LARGEST_RESULT_BYTES), path)
        changed_s = path.stat().st_mtime
    except (ConfigError, OSError):
        return None
    kind = str(data.get("format", "")).partition("/")[0] if isinstance(data, dict) else ""
    if kind not in _KINDS:
        return None
    runs = _runs_of(data)
    return StoredResult(
        path,
        kind,
        kind != "catseye-result" or data.get("model") == "error-map",
        runs,
        _measured(runs) or datetime.fromtimestamp(changed_s, UTC),
        changed_s,
    )


def results_in(folders: Iterable[Path]) -> dict[str, Path]:
    """Return the newest result of each run that one was made from, by its name."""
    return by_run(result for result in stored_results(folders) if result.counts)


def by_run(newest_first: Iterable[StoredResult]) -> dict[str, Path]:
    """Return the newest of each run that one was made from, by its name."""
    found: dict[str, Path] = {}
    for result in newest_first:
        for run in result.runs:
            found.setdefault(run, result.path)
    return found


def _runs_of(data: dict[str, Any]) -> tuple[str, ...]:
    provenance = data.get("provenance")
    runs = provenance.get("runs") if isinstance(provenance, dict) else None
    return tuple(str(run) for run in runs) if isinstance(runs, list) else ()


def _measured(runs: Iterable[str]) -> datetime | None:
    return min((start_of(named) for run in runs if (named := run_name(run)) is not None), default=None)
