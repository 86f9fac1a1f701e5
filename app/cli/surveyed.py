"""What a cell is ready for, surveyed with its progress shown."""

from contextlib import closing
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Final

from catseye.app.cli.progress import ProgressBar

_LOOK_S: Final = 1.0
"""How long an emulated bench is waited for."""

if TYPE_CHECKING:
    from catseye.app.results.readiness.bench_seen import BenchSeen
    from catseye.app.results.readiness.headline import Headlines
    from catseye.app.results.readiness.survey import Scope, Survey


def surveyed(
    cell: Path,
    root: Path,
    now: datetime,
    present: "BenchSeen | None" = None,
    *,
    remember: bool = True,
    scope: "Scope | None" = None,
) -> "Survey":
    """Return what a cell is ready for.

    Args:
        cell: its file.
        root: folder of the runs.
        now: UTC time at which runs have to be fresh.
        present: what is seen of the bench now; None where nobody looks.
        scope: what of the cell counts; None for everything.
        remember: take the figures of finished stages as an earlier look has found them, while nothing has changed.

    Raises:
        ConfigError: the cell file cannot be used.
    """
    from catseye.app.results.readiness.bench_seen import NOTHING_SEEN
    from catseye.app.results.readiness.remembered import Remembered
    from catseye.app.results.readiness.survey import EVERYTHING, survey_cell

    remembered = Remembered(root, _evaluation) if remember else None
    headlines = _evaluation() if remembered is None else remembered.headlines
    with closing(ProgressBar("procedures")) as bar:

        def tried(done: int, of: int, name: str) -> None:
            bar.hint(done, of, f"{done} of {of} plans tried, {name} next")

        survey = survey_cell(cell, root, now, headlines, present or NOTHING_SEEN, tried, scope or EVERYTHING)
    if remembered is not None:
        remembered.keep()
    return survey


def _evaluation() -> "Headlines":
    from catseye.app.results.headlines import HEADLINES

    return HEADLINES


def bench_now(cell: Path) -> "BenchSeen":
    """Return what is seen of a cell's bench now: which start of its emulators answers; nothing where none does.

    Raises:
        ConfigError: the cell file cannot be used.
    """
    from catseye.app.cell.hands import hands_endpoint
    from catseye.app.cell.load import load_cell
    from catseye.app.results.readiness.bench_seen import NOTHING_SEEN, BenchSeen
    from catseye.simulators.control_port.client import ask_blocking
    from catseye.simulators.control_port.messages import Identify

    endpoint = hands_endpoint(load_cell(cell).cell)
    if endpoint is None:
        return NOTHING_SEEN
    try:
        return BenchSeen(ask_blocking(endpoint, Identify(), _LOOK_S).started)
    except (OSError, ValueError):
        # It does not run, or is a real instrument: runs tell what they know.
        return NOTHING_SEEN
