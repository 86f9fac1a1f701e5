"""Figures of finished stages, kept beside the runs until a file behind one changes.

To evaluate a run takes seconds, and the day's list looks at all of them each time. The file may be deleted at any
time: whatever is missing in it, or cannot be read, is evaluated anew.
"""

import contextlib
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from pydantic import BaseModel, ConfigDict, ValidationError

from catseye.app.errors import StorageError
from catseye.app.files.atomic import write_atomically
from catseye.app.results.readiness.headline import Headline, Headlines, Written
from catseye.app.store.seal import DATABASE
from catseye.app.store.software import SOFTWARE

REMEMBERED: Final = ".figures.json"

_Stamp = tuple[tuple[int, int], ...]
"""Time of change and size of each file behind a figure."""


class _Figure(BaseModel):
    """A figure; its text is None where nothing stands for the stage."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    stamp: _Stamp
    text: str | None
    holds: bool = True


class _Figures(BaseModel):
    """All figures of a folder, as one version of the program has found them."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    software: str
    figures: dict[str, _Figure]


class Remembered:
    """Returns figures that are known, and finds out the others.

    Args:
        root: folder of the runs.
        evaluation: returns what finds figures out; called where one is missing, as to load it takes its time, too.
    """

    def __init__(self, root: Path, evaluation: Callable[[], Headlines]) -> None:
        self._file = root / REMEMBERED
        self._known = _read(self._file)
        self._changed = False
        self.headlines = Headlines(
            lambda run: self._figure("run", (run,), lambda: evaluation().of_run(run)),
            lambda result: self._figure("result", (result,), lambda: evaluation().of_result(result)),
            lambda written: self._figure(
                written.command, _behind(written), lambda: evaluation().of_written(written)
            ),
        )

    def keep(self) -> None:
        """Store what was found out; a folder that cannot be written to is left as it is."""
        if not self._changed or not self._file.parent.is_dir():
            return
        figures = _Figures(software=SOFTWARE, figures=self._known)
        with contextlib.suppress(StorageError):
            write_atomically(self._file, figures.model_dump_json())

    def _figure(
        self, kind: str, behind: Sequence[Path], find_out: Callable[[], Headline | None]
    ) -> Headline | None:
        key = "\n".join((kind, *(str(path.absolute()) for path in behind)))
        # Before the look: what changes meanwhile is looked at again.
        stamp = _stamp(behind)
        known = self._known.get(key)
        if known is None or known.stamp != stamp:
            found = find_out()
            known = (
                _Figure(stamp=stamp, text=None)
                if found is None
                else _Figure(stamp=stamp, text=found.text, holds=found.holds)
            )
            self._known[key], self._changed = known, True
        return None if known.text is None else Headline(known.text, known.holds)


def _behind(written: Written) -> tuple[Path, ...]:
    return (written.file, *written.results, *written.runs)


def _stamp(behind: Sequence[Path]) -> _Stamp:
    """Return what changes with any of the files; of a run, with its database and the log of that."""
    found = []
    for path in behind:
        for file in (path / DATABASE, path / f"{DATABASE}-wal") if path.is_dir() else (path,):
            with contextlib.suppress(OSError):
                facts = os.stat(file)
                found.append((facts.st_mtime_ns, facts.st_size))
    return tuple(found)


def _read(file: Path) -> dict[str, _Figure]:
    try:
        figures = _Figures.model_validate_json(file.read_bytes())
    except (OSError, ValidationError):
        return {}
    return figures.figures if figures.software == SOFTWARE else {}
