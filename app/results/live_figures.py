"""Figures of a run while it is under way, whatever arm it is on: those of its report, as far as it has come."""

from pathlib import Path

from catseye.app.results.figures import Figure
from catseye.app.results.found import found_sections
from catseye.app.results.scara.found.commands import Progress, measures_commands
from catseye.app.results.scara.found.measuring import measuring_figures
from catseye.app.store.reader import RunReader


class LiveFigures:
    """Looks at a run again and again; it opens files and computes, so call it in a thread.

    Args:
        path: folder of the run.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._progress: Progress | None = None

    def look(self) -> tuple[Figure, ...]:
        """Return the figures of what the run holds by now.

        Raises:
            CatseyeError: the record cannot be read, or does not say what it was made with.
        """
        reader = RunReader(self._path)
        if measures_commands(reader):
            self._progress = self._progress or Progress(reader)
            return measuring_figures(self._progress.look(reader))
        sections = found_sections(reader)
        return tuple(block for one in sections for block in one.blocks if isinstance(block, Figure))
