"""What lies beside the runs and was made of one of them, whoever wrote it and whatever it is called."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from catseye.app.errors import StorageError
from catseye.app.results.stored_results import StoredResult, stored_results
from catseye.app.store.reader import Accept, RunReader

_HEAD_BYTES: Final = 16_384
"""The title of a page and the head of a table stand in these."""

_MOST_BYTES: Final = 64 * 1024 * 1024
"""No page of a run is larger."""

_CORRECTED: Final = {
    ".csv": ("correction1_mdeg", "uncorrected_mm"),
    ".json": ('"catseye-compensation/',),
    ".prg": ("catseye",),
    ".mod": ("CATSCOMP",),
    ".src": ("CATSCOMP",),
    ".ssfk": ("catseye",),
}
"""What stands in files of corrected commands, by their ending."""


@dataclass(frozen=True)
class RunFiles:
    """Files of a run.

    Attributes:
        result: the newest result made of it, that counts on the way of its cell.
        report: the newest page about it.
        compensation: the newest file of commands that were corrected by that result.
        results_of_arm: how many results of its cell there are.
    """

    result: Path | None = None
    report: Path | None = None
    compensation: Path | None = None
    results_of_arm: int = 0

    def written(self) -> dict[str, Path]:
        """Return the files by what writes them."""
        named = {"result": self.result, "report": self.report, "compensate": self.compensation}
        return {name: file for name, file in named.items() if file is not None}


NO_FILES: Final = RunFiles()
"""Before anybody has looked."""


def files_of_run(run: str, root: Path, result: Path | None = None) -> RunFiles:
    """Return the files of a run; it reads files: call it in a thread.

    Args:
        result: by which commands are corrected where the run has none of its own.
    """
    folders = [folder for folder in dict.fromkeys((root.absolute().parent, root)) if folder.is_dir()]
    counting = [one for one in stored_results(folders) if one.counts]
    own = next((one.path for one in counting if run in one.runs), None)
    by = own or result
    return RunFiles(
        own,
        _report_of(run, folders),
        None if by is None else _compensation_by(by, run, folders),
        _results_of_cell(run, root, counting),
    )


def _report_of(run: str, folders: Iterable[Path]) -> Path | None:
    """Return the newest page whose title names the procedure, and whose text names the run."""
    procedure = run.partition("_")[2].rpartition("_")[0]
    title, name = f"<title>{procedure} on ".encode(), run.encode()
    pages = _newest_first(folders, frozenset({".html"}))
    return next(
        (page for page in pages if title in _bytes_of(page, _HEAD_BYTES) and name in _bytes_of(page)), None
    )


def _compensation_by(result: Path, run: str, folders: Iterable[Path]) -> Path | None:
    """Return the newest file of corrected commands that names the result, or is called after the run."""
    named = re.compile(rf'(from |by |"result": "){re.escape(result.name)}["\s(,:]')
    called = f"compensated-{run.rpartition('_')[2]}"
    for file in _newest_first([*folders, result.parent], frozenset(_CORRECTED)):
        head = _bytes_of(file, _HEAD_BYTES).decode(errors="replace")
        ours = any(mark in head for mark in _CORRECTED[file.suffix])
        if ours and (named.search(head) or file.stem.startswith(called)):
            return file
    return None


def _results_of_cell(run: str, root: Path, counting: Iterable[StoredResult]) -> int:
    """Return how many results were made of runs of the same cell."""
    cell = cell_of_run(root / run)
    known: dict[str, object] = {}
    return sum(
        any(known.setdefault(name, cell_of_run(root / name)) == cell for name in one.runs)
        for one in counting
        if cell is not None
    )


def cell_of_run(run: Path) -> object:
    """Return the name of a run's cell; None of one that cannot be read."""
    try:
        return RunReader(run, Accept.UNCHECKED).meta.get("cell")
    except StorageError:
        return None


def _newest_first(folders: Iterable[Path], endings: frozenset[str]) -> Iterator[Path]:
    files = {file.absolute() for folder in folders for file in folder.iterdir() if file.suffix in endings}
    stated = [(file.stat().st_mtime, file) for file in files if file.is_file()]
    return (file for _, file in sorted(stated, reverse=True))


def _bytes_of(file: Path, most: int = _MOST_BYTES) -> bytes:
    try:
        with file.open("rb") as opened:
            return opened.read(most)
    except OSError:
        return b""
