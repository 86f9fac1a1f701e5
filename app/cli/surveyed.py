"""What a cell is ready for, surveyed with its progress shown."""

from contextlib import closing
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from catseye.app.cli.progress import ProgressBar

if TYPE_CHECKING:
    from catseye.app.results.readiness.survey import Survey


def surveyed(cell: Path, root: Path, now: datetime) -> "Survey":
    """Return what a cell is ready for.

    Args:
        cell: its file.
        root: folder of the runs.
        now: UTC time at which runs have to be fresh.

    Raises:
        ConfigError: the cell file cannot be used.
    """
    from catseye.app.results.headlines import HEADLINES
    from catseye.app.results.readiness.survey import survey_cell

    with closing(ProgressBar("procedures")) as bar:

        def tried(done: int, of: int, name: str) -> None:
            bar.hint(done, of, f"{done} of {of} plans tried, {name} next")

        return survey_cell(cell, root, now, HEADLINES, tried)
